//! FMUs that other tools made: `pythonfmu` (FMI 2.0) and `pythonfmu3` (FMI 3.0).
