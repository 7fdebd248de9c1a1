//! FMI 2.0 and 3.0: the FMUs of any tool loaded, checked and run (`import`), and coupled (`cosim`).

#[cfg(feature = "import")]
pub mod cosim;
#[cfg(feature = "import")]
pub mod import;
