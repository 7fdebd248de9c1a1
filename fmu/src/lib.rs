//! FMI 2.0 and 3.0.
//!
//! [`description`] says what an FMU is; `export` turns a Rust model into the C functions of a
//! shared library; `archive` packs description, library and resources into a `.fmu` file.
//! `import` loads, checks and runs the FMUs of any tool, `cosim` couples them.

#[cfg(feature = "export")]
pub mod archive;
#[cfg(feature = "import")]
pub mod cosim;
pub mod description;
#[cfg(feature = "export")]
pub mod export;
#[cfg(feature = "import")]
pub mod import;
#[cfg(feature = "import")]
mod position;
mod vocabulary;
mod xml;
