//! What an FMI function returns. The numbers are the same in FMI 2.0 and 3.0, but for `Pending`,
//! which only 2.0 has.

use std::fmt;

/// The status that an FMI function returned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// All is well.
    Ok,
    /// Unusual, but the run can go on.
    Warning,
    /// The step or value could not be computed; a smaller step may do.
    Discard,
    /// The call failed; the instance can only be reset or freed.
    Error,
    /// The whole FMU is corrupt.
    Fatal,
    /// An asynchronous step that has not ended.
    Pending,
    /// The binary has no such function.
    Missing,
    /// A number that the standard does not define.
    Undefined(i32),
}

impl Status {
    /// Reads the C value: FMUs are foreign code, so any number can come.
    pub(crate) fn from_c(value: i32) -> Status {
        match value {
            0 => Status::Ok,
            1 => Status::Warning,
            2 => Status::Discard,
            3 => Status::Error,
            4 => Status::Fatal,
            5 => Status::Pending,
            other => Status::Undefined(other),
        }
    }

    /// Whether the run can go on.
    pub fn is_good(self) -> bool {
        matches!(self, Status::Ok | Status::Warning)
    }
}

impl fmt::Display for Status {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Status::Ok => out.write_str("OK"),
            Status::Warning => out.write_str("Warning"),
            Status::Discard => out.write_str("Discard"),
            Status::Error => out.write_str("Error"),
            Status::Fatal => out.write_str("Fatal"),
            Status::Pending => out.write_str("Pending"),
            Status::Missing => out.write_str("nothing (the binary has no such function)"),
            Status::Undefined(value) => write!(out, "the undefined status {value}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_status_that_the_standard_does_not_know_is_bad() {
        assert!(Status::from_c(1).is_good());
        for value in [-1, 2, 3, 4, 5, 6, 42] {
            assert!(!Status::from_c(value).is_good(), "{value}");
        }
        assert_eq!(Status::from_c(42).to_string(), "the undefined status 42");
    }
}
