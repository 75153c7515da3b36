//! A tire that a host written in C, or anything that calls C, steps itself: `latsch_tire` of `include/latsch_tire.h`.

latsch::export_tire_function!();
