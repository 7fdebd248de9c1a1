//! How fast the speed of a drive settles.

use drivescope_plant::drive::Drive;

/// The torque that brakes a drive a unit of its speed, N m s/rad (N s/m): viscous friction, and the
/// back-EMF through the armature.
pub(crate) fn damping(drive: &Drive) -> f64 {
    let motor = &drive.motor;
    let braking = match (motor.r, motor.k_e) {
        (Some(r), Some(k_e)) => motor.k_m * k_e / r,
        _ => 0.0,
    };
    motor.b_m + braking
}

/// The time in which the speed of a drive settles, s: J over what brakes it.
pub fn mechanical_time_s(drive: &Drive) -> f64 {
    drive.motor.j / damping(drive)
}
