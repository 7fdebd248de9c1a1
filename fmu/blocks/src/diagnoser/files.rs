//! Names of the files among an FMU's resources.

/// Name of the diagnoser file among the FMU's resources.
pub const DIAGNOSER_FILE: &str = "diagnoser.toml";
/// Name of the healthy run of the machine, where one was given at the export.
pub const BASELINE_FILE: &str = "baseline.toml";
