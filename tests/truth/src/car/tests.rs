//! The car, and cases as they are drawn.
