"""What sensors and the input do to the signals."""

import numpy as np

from .laws import Law, signed


def _draw_speed_sensor_lag(rng, m, size):
    """Size: time constant, s."""
    return {"lag": size * rng.uniform(0.7, 1.4)}


def _draw_tacho_eccentricity(rng, m, size):
    """Size: relative ripple of the shown speed."""
    return {"depth": size, "phase": rng.uniform(0.0, 2 * np.pi)}


def _draw_current_offset(rng, m, size):
    """Size: offset, a share of the rated current."""
    return {"offset": signed(rng) * size * m.amps}


def _draw_tacho_gain(rng, m, size):
    """Size: relative error of the gain."""
    return {"gain": signed(rng) * size}


def _draw_delay(rng, m, size):
    """Size: by how much u comes late, s."""
    return {"delay": size * rng.uniform(0.5, 1.2)}


LAWS = [
    Law("speed_sensor_lag", ("acceleration",), 0.01, _draw_speed_sensor_lag),
    Law("tacho_eccentricity", ("theta",), 0.02, _draw_tacho_eccentricity),
    Law("current_offset", ("i",), 0.08, _draw_current_offset),
    Law("tacho_gain", (), 0.05, _draw_tacho_gain),
    Law("delay", ("acceleration",), 0.0007, _draw_delay),
]
