//! Machines of no one's choosing: random mechanisms, drives and stores as FMUs of somebody else, with effects concealed
//! by their physics and sized by how far they can be seen.
//!
//! Nothing here depends on latsch. The unit is C code ([`mod@unit`]), the truth another program; both come from the same
//! [`mechanism`], and agree where nothing is concealed.

mod case;
pub mod conceal;
pub mod draw;
pub mod mechanism;
mod offers;
pub mod unit;
mod view;
mod world;

pub use case::{Kind, count, recorded, write_case};
pub(crate) use case::{size, spread};
pub use view::{VIEWS, View};
