"""What repeats with the angle of the rotor."""

import numpy as np

from .laws import Law


def _cogging(total, s, p):
    """Two harmonics; the library's law has one."""
    angle = p["periods"] * s.theta + p["phase"]
    total.torque += p["height"] * (np.cos(angle) + 0.25 * np.cos(2 * angle + p["second"]))


def _draw_cogging(rng, m, size):
    """Size: amplitude, a share of the rated torque."""
    return {
        "height": size * m.rated_torque,
        "periods": float(rng.choice([2, 3, 4, 6, 8, 12])),
        "phase": rng.uniform(0.0, 2 * np.pi),
        "second": rng.uniform(0.0, 2 * np.pi),
    }


def _unbalance(total, s, p):
    """Gravity on an eccentric mass that hangs in a soft mount: a trace of the second harmonic."""
    angle = s.theta + p["phase"]
    total.torque += p["height"] * (np.sin(angle) + 0.05 * np.sin(2 * angle))


def _draw_unbalance(rng, m, size):
    """Size: amplitude, a share of the rated torque."""
    return {"height": size * m.rated_torque, "phase": rng.uniform(0.0, 2 * np.pi)}


def _torque_ripple(total, s, p):
    angle = p["periods"] * s.theta + p["phase"]
    total.flux = total.flux * (1.0 + p["depth"] * (np.cos(angle) + 0.2 * np.cos(3 * angle)))


def _draw_torque_ripple(rng, m, size):
    """Size: relative amplitude of the flux."""
    return {
        "depth": size,
        "periods": float(rng.choice([2, 3, 4, 6, 8])),
        "phase": rng.uniform(0.0, 2 * np.pi),
    }


LAWS = [
    Law("cogging", ("theta",), 0.08, _draw_cogging, _cogging),
    Law("unbalance", ("theta",), 0.08, _draw_unbalance, _unbalance),
    Law("torque_ripple", ("theta",), 0.05, _draw_torque_ripple, _torque_ripple),
]
