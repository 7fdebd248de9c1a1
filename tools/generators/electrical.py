"""What hides in the armature circuit and the magnetic one."""

import numpy as np

from .laws import Law


def _saturation(total, s, p):
    total.flux = total.flux / (1.0 + np.abs(s.i / p["amps"]) ** 1.8)


def _draw_saturation(rng, m, size):
    """Size: loss of flux at 20 % of the stall current."""
    return {"amps": 0.2 * m.volts / m.R / (size / (1.0 - size)) ** (1 / 1.8)}


def _armature_reaction(total, s, p):
    total.flux = total.flux * np.maximum(1.0 - p["loss"] * np.abs(s.i / p["amps"]) ** 1.1, 0.3)


def _draw_armature_reaction(rng, m, size):
    """Size: loss of flux at 20 % of the stall current."""
    return {"loss": size, "amps": 0.2 * m.volts / m.R}


def _brush_drop(total, s, p):
    total.drop = total.drop + p["volts"] * np.tanh(s.i / p["amps"])


def _draw_brush_drop(rng, m, size):
    """Size: drop, a share of the supply voltage."""
    return {"volts": size * m.volts, "amps": rng.uniform(0.05, 0.15) * m.amps}


def _dead_time(total, s, p):
    total.drop = total.drop + p["volts"] * s.i / np.sqrt(s.i**2 + p["amps"] ** 2)


def _draw_dead_time(rng, m, size):
    """Size: voltage lost to the dead time, a share of the supply voltage."""
    return {"volts": size * m.volts, "amps": rng.uniform(0.02, 0.06) * m.amps}


def _draw_winding_heating(rng, m, size):
    """Size: relative rise of the resistance in 8 s at 15 % of the stall current."""
    slow = rng.uniform(6.0, 12.0)
    return {"rise": size / 8.0 / (0.15 * m.volts / m.R) ** 2, "slow": slow}


def _supply_sag(total, s, p):
    """The rail falls with the power drawn from it; nearly a higher resistance."""
    total.supply = total.supply - p["sag"] * np.maximum(s.u * s.i, 0.0) / p["watts"]


def _draw_supply_sag(rng, m, size):
    """Size: fall of the supply at 20 % of the stall power, a share."""
    return {"sag": size, "watts": 0.2 * m.volts**2 / m.R}


def _iron_loss(total, s, p):
    total.torque += p["level"] * np.sign(s.w) * np.abs(s.w / p["speed"]) ** 0.6


def _draw_iron_loss(rng, m, size):
    """Size: torque at half the top speed, a share of the rated."""
    return {"level": size * m.rated_torque, "speed": 0.5 * m.top_speed}


LAWS = [
    Law("saturation", ("i",), 0.15, _draw_saturation, _saturation, {"amps": np.inf}),
    Law(
        "armature_reaction",
        ("i",),
        0.12,
        _draw_armature_reaction,
        _armature_reaction,
        {"amps": 1.0},
    ),
    Law("brush_drop", ("i",), 0.03, _draw_brush_drop, _brush_drop, {"amps": 1.0}),
    Law("dead_time", ("i",), 0.03, _draw_dead_time, _dead_time, {"amps": 1.0}),
    Law(
        "winding_heating", ("temperature", "time"), 0.4, _draw_winding_heating, None, {"slow": 1.0}
    ),
    Law("supply_sag", (), 0.1, _draw_supply_sag, _supply_sag, {"watts": 1.0}),
    Law("iron_loss", (), 0.05, _draw_iron_loss, _iron_loss, {"speed": 1.0}),
]
