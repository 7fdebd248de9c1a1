//! Published figures that anyone can measure again.

pub(crate) mod discovery;
mod rate;
pub(crate) mod speed;

use std::path::PathBuf;

/// The Python that runs what other programs are asked: that of DRIVESCOPE_PYTHON, or `python3` on the
/// path.
fn python() -> PathBuf {
    std::env::var_os("DRIVESCOPE_PYTHON").map_or_else(|| PathBuf::from("python3"), PathBuf::from)
}
