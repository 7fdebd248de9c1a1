//! Tests of the import side with real FMUs: small ones compiled from C here, and foreign ones that
//! `pythonfmu` and `pythonfmu3` make. What a machine lacks for them is printed as NOT RUN.

mod cosim;
#[cfg(feature = "export")]
mod exported;
mod foreign;
mod lifecycle;
mod model_exchange;
mod refusals;
mod run;
mod support;
mod system_files;
mod validate;
