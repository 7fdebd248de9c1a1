"""Effects that no library has: what is found must be shown, not forced into a name."""

import numpy as np

from .laws import Law


def _speed_bump(total, s, p):
    """A brush that chatters around one speed."""
    away = (np.abs(s.w) - p["speed"]) / p["width"]
    total.torque += p["height"] * np.sign(s.w) * np.exp(-0.5 * away**2)


def _draw_speed_bump(rng, m, size):
    """Size: torque, a share of the rated."""
    speed = rng.uniform(0.15, 0.3) * m.top_speed
    return {"height": size * m.rated_torque, "speed": speed, "width": 0.2 * speed}


def _tight_spot(total, s, p):
    """A bent shaft: dry friction is higher around one angle."""
    extra = p["height"] * np.exp(4.0 * (np.cos(s.theta - p["angle"]) - 1.0))
    total.forward += extra
    total.backward += extra


def _draw_tight_spot(rng, m, size):
    """Size: extra level, a share of Coulomb friction."""
    return {"height": size * m.T_c, "angle": rng.uniform(0.0, 2 * np.pi)}


def _curved_resistance(total, s, p):
    """A contact whose resistance grows with the current."""
    total.resistance = total.resistance + p["rise"] * np.sqrt(np.abs(s.i / p["amps"]))


def _draw_curved_resistance(rng, m, size):
    """Size: relative resistance added at 20 % of the stall current."""
    return {"rise": size, "amps": 0.2 * m.volts / m.R}


def _touch(total, s, p):
    """Somebody's hand on the shaft for a while."""
    while_on = 0.5 * (np.tanh((s.time - p["from"]) / 0.05) - np.tanh((s.time - p["to"]) / 0.05))
    total.forward += p["height"] * while_on
    total.backward += p["height"] * while_on


def _draw_touch(rng, m, size):
    """Size: extra level, a share of Coulomb friction."""
    start = rng.uniform(1.0, 5.0)
    return {"height": size * m.T_c, "from": start, "to": start + rng.uniform(1.0, 2.0)}


def _leaning_field(total, s, p):
    """Flux that depends on the sign and size of the speed: a moving-iron effect."""
    total.flux = total.flux * (1.0 - p["depth"] * np.tanh(np.abs(s.w / p["speed"])) ** 2)


def _draw_leaning_field(rng, m, size):
    """Size: loss of flux at high speed."""
    return {"depth": size, "speed": 0.25 * m.top_speed}


LAWS = [
    Law(
        "x_speed_bump",
        ("omega",),
        0.1,
        _draw_speed_bump,
        _speed_bump,
        {"speed": 1.0, "width": 1.0},
        known=False,
    ),
    Law("x_tight_spot", ("theta",), 0.7, _draw_tight_spot, _tight_spot, known=False),
    Law(
        "x_curved_resistance",
        ("i",),
        0.25,
        _draw_curved_resistance,
        _curved_resistance,
        {"amps": 1.0},
        known=False,
    ),
    Law("x_touch", ("time",), 0.8, _draw_touch, _touch, known=False),
    Law(
        "x_leaning_field",
        ("omega",),
        0.12,
        _draw_leaning_field,
        _leaning_field,
        {"speed": 1.0},
        known=False,
    ),
]
