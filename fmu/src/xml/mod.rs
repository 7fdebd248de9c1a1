//! XML: elements to be written, and documents to be read with places.

#[cfg(feature = "export")]
pub(crate) mod element;
#[cfg(feature = "import")]
pub(crate) mod read;
