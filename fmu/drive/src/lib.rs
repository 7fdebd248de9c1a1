//! The shared library inside every exported FMU: the C functions of FMI 2.0 and 3.0 over
//! [`DriveModel`].

use drivescope_fmu_blocks::DriveModel;

drivescope_fmu::export_model!(DriveModel);
