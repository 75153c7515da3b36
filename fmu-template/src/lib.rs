//! The binary inside the FMUs. To make FMUs of own models, copy this crate and name them here:
//! `latsch::export_fmus!(MyModel, AnotherModel);`

latsch::export_fmus!(entries: latsch::shipped::MODELS);
