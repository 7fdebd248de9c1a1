"""Random machines: motors of several sizes, every parameter drawn around its size."""

from dataclasses import dataclass, fields

import numpy as np

SPREAD = 0.2
"""Standard deviation of the logarithm of every parameter around its size."""


@dataclass
class Machine:
    """Parameters in SI units, one entry a machine."""

    volts: np.ndarray
    """Supply voltage, V."""
    R: np.ndarray
    L: np.ndarray
    K: np.ndarray
    """Torque and back-EMF constant: they are equal in SI units."""
    J: np.ndarray
    B: np.ndarray
    T_c: np.ndarray
    amps: np.ndarray
    """Rated current, A."""

    @property
    def rated_torque(self):
        return self.K * self.amps

    @property
    def top_speed(self):
        """Speed without load at the supply voltage, rad/s."""
        return self.volts / self.K

    def take(self, index):
        """The machines with these indices (a number: scalars)."""
        return Machine(*(getattr(self, field.name)[index] for field in fields(self)))


SIZES = {
    #               volts  R     L       K      J       B       T_c    amps
    "dr300": (24.0, 3.13, 5.0e-3, 0.060, 8.2e-5, 6.0e-5, 0.016, 2.0),
    "small 12 V": (12.0, 2.2, 2.5e-3, 0.022, 1.1e-5, 3.0e-6, 0.0028, 1.4),
    "servo 48 V": (48.0, 0.9, 2.5e-3, 0.115, 4.0e-4, 2.0e-4, 0.032, 5.0),
    "gear motor 24 V": (24.0, 5.0, 6.0e-3, 0.042, 2.4e-5, 8.0e-6, 0.007, 1.2),
    "armature 180 V": (180.0, 1.6, 1.0e-2, 0.85, 1.5e-2, 3.0e-3, 0.30, 9.0),
}


def draw(rng, count):
    """`count` machines and the name of the size each was drawn around."""
    names = list(rng.choice(list(SIZES), size=count))
    middle = np.array([SIZES[name] for name in names])
    factors = np.exp(SPREAD * np.clip(rng.standard_normal(middle.shape), -2.0, 2.0))
    # The supply and the rating are what they are.
    factors[:, [0, 7]] = 1.0
    return Machine(*(middle * factors).T), names
