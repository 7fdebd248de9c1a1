"""What hangs on the shaft."""

import numpy as np

from .laws import Law, signed


def _constant_load(total, s, p):
    total.torque += p["level"]


def _draw_constant_load(rng, m, size):
    """Size: torque, a share of the rated."""
    return {"level": signed(rng) * size * m.rated_torque}


def _draw_flexible_coupling(rng, m, size):
    """Size: share of the inertia that is far; resonance drawn from 12 to 35 Hz."""
    share = size * rng.uniform(0.8, 1.2)
    rate = 2 * np.pi * rng.uniform(12.0, 35.0)
    both = m.J * share * (1.0 - share)
    return {
        "share": share,
        "stiffness": both * rate**2,
        "damping": 2 * rng.uniform(0.03, 0.08) * both * rate,
        "play": 0.0,
    }


def _draw_backlash(rng, m, size):
    """Size: play, rad; half of the inertia lies behind it, the contact is at 60 Hz."""
    share, rate = 0.5, 2 * np.pi * 60.0
    both = m.J * share * (1.0 - share)
    return {
        "share": share,
        "stiffness": both * rate**2,
        "damping": 2 * 0.2 * both * rate,
        "play": 0.5 * size * rng.uniform(0.7, 1.4),
    }


LAWS = [
    Law("constant_load", ("omega_sign",), 0.05, _draw_constant_load, _constant_load),
    Law("flexible_coupling", ("acceleration",), 0.35, _draw_flexible_coupling),
    Law("backlash", ("acceleration",), 0.3, _draw_backlash),
]
