"""Machines of any size: from 1 W to 10 kW by the rules of thumb of motor catalogues, with a gear,
or as a linear axis.

A catalogue motor of rated power P has a supply voltage that grows with it, a no-load speed that
falls, loses a tenth or so of the voltage over its resistance at the rated current, and is as quick
as its two time constants say: L / R from 0.3 ms to 10 ms, J R / K^2 from 5 ms to 60 ms.
"""

import numpy as np

from .machine import Machine

WATTS = (1.0, 1e4)
VOLTS = ((10.0, 6.0), (50.0, 12.0), (200.0, 24.0), (600.0, 48.0), (3e3, 180.0), (np.inf, 400.0))
"""Up to that power, W, the supply is that many volts."""
GEARS = (3.0, 150.0)
GEAR_FRICTION = (1.2, 2.0)
"""How much dry friction grows by the gear's teeth and seals."""
METRES = (0.01, 0.08)
"""Travel of a linear axis for one radian of its motor."""


def _log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def motor(rng):
    """Parameters of a motor in the order of `Machine`, and its rated power, W."""
    watts = _log_uniform(rng, *WATTS)
    share = np.log(watts / WATTS[0]) / np.log(WATTS[1] / WATTS[0])
    volts = next(volts for most, volts in VOLTS if watts <= most)
    top = np.exp(np.interp(share, (0, 1), np.log((1000.0, 180.0)))) * rng.uniform(0.7, 1.4)
    K = volts / top
    amps = watts / volts * rng.uniform(1.1, 1.4)
    R = np.interp(share, (0, 1), (0.25, 0.05)) * rng.uniform(0.7, 1.4) * volts / amps
    slow = np.exp(np.interp(share, (0, 1), np.log((3e-4, 1e-2)))) * rng.uniform(0.7, 1.4)
    J = np.exp(np.interp(share, (0, 1), np.log((8e-3, 4e-2)))) * rng.uniform(0.6, 1.6) * K * K / R
    rated = K * amps
    B, T_c = rated * rng.uniform(0.01, 0.06) / top, rated * rng.uniform(0.03, 0.12)
    return Machine(volts, R, slow * R, K, J, B, T_c, amps), watts


def geared(rng, m):
    """The same seen from the slow shaft of a gear, on which the sensor sits; and its ratio."""
    n = _log_uniform(rng, *GEARS)
    dry = n * rng.uniform(*GEAR_FRICTION) * m.T_c
    return Machine(m.volts, m.R, m.L, n * m.K, n * n * m.J, n * n * m.B, dry, m.amps), n


def axis(rng, m):
    """The same as a carriage: metres and newtons for radians and newton metres; and the travel for
    a radian, m."""
    r = _log_uniform(rng, *METRES)
    rest = (m.K / r, m.J / r**2, m.B / r**2, m.T_c / r)
    return Machine(m.volts, m.R, m.L, *rest, m.amps), r


def together(machines):
    """Machines of one entry each as one of many."""
    names = list(Machine.__dataclass_fields__)
    return Machine(*(np.array([getattr(m, name) for m in machines], dtype=float) for name in names))
