//! The shared library inside every exported FMU of a diagnoser: the C functions of FMI 2.0 and 3.0
//! over [`DiagnoserModel`].

use drivescope_fmu_blocks::DiagnoserModel;

drivescope_fmu::export_model!(DiagnoserModel);
