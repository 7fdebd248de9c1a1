"""Friction and drag beyond Coulomb and viscous."""

import numpy as np

from .laws import Law, signed


def _asymmetric(total, s, p):
    total.forward += p["dry"]
    total.backward -= p["dry"]
    # The viscous part differs by direction, smoothly around rest.
    total.torque += p["viscous"] * s.w * np.tanh(s.w / p["blend"])


def _draw_asymmetric(rng, m, size):
    """Size: half difference of Coulomb friction, a share of it; the same of the speed-dependent."""
    sign = signed(rng)
    viscous = sign * rng.uniform(0.0, 0.5) * size * m.T_c / (0.5 * m.top_speed)
    return {"dry": sign * size * m.T_c, "viscous": viscous, "blend": 0.002 * m.top_speed}


def _stribeck(total, s, p):
    """exp(-|w/ws|^1.3); the library's exponent is 2."""
    extra = p["extra"] * np.exp(-(np.abs(s.w / p["speed"]) ** 1.3))
    total.forward += extra
    total.backward += extra


def _draw_stribeck(rng, m, size):
    """Size: what break-away adds to Coulomb friction, a share of it."""
    return {"extra": size * m.T_c, "speed": rng.uniform(0.015, 0.05) * m.top_speed}


def _quadratic_drag(total, s, p):
    total.torque += p["top"] * np.sign(s.w) * np.abs(s.w / p["speed"]) ** 1.9


def _draw_quadratic_drag(rng, m, size):
    """Size: torque at half the top speed, a share of the rated."""
    return {"top": size * m.rated_torque, "speed": 0.5 * m.top_speed}


def _load_friction(total, s, p):
    """Grows with the transmitted torque; rounded at no load, where the library's has an edge."""
    rounded = np.sqrt(s.drive**2 + p["round"] ** 2) - p["round"]
    total.forward += p["share"] * rounded
    total.backward += p["share"] * rounded


def _draw_load_friction(rng, m, size):
    """Size: loss, a share of the transmitted torque."""
    return {"share": size, "round": 0.03 * m.rated_torque}


def _friction_drift(total, s, p):
    """Warming up: falls towards a lower level; the library's law is a straight line."""
    change = p["change"] * -np.expm1(-s.time / p["slow"])
    total.forward += change
    total.backward += change


def _draw_friction_drift(rng, m, size):
    """Size: change at the end of a long run, a share of Coulomb friction."""
    return {"change": -size * m.T_c * rng.choice([1.0, -1.0]), "slow": rng.uniform(4.0, 8.0)}


def _draw_presliding(rng, m, size):
    """Size: deflection at which bristles slip, rad."""
    return {"bristle": size * rng.uniform(0.7, 1.4)}


LAWS = [
    Law("asymmetric_friction", ("omega_sign",), 0.3, _draw_asymmetric, _asymmetric, {"blend": 1.0}),
    Law("stribeck", ("omega",), 0.5, _draw_stribeck, _stribeck, {"speed": 1.0}),
    Law(
        "quadratic_drag",
        ("omega",),
        0.15,
        _draw_quadratic_drag,
        _quadratic_drag,
        {"speed": 1.0},
    ),
    Law("load_friction", ("i", "omega"), 0.12, _draw_load_friction, _load_friction),
    Law("friction_drift", ("time",), 0.4, _draw_friction_drift, _friction_drift, {"slow": 1.0}),
    Law("presliding", ("omega", "omega_sign", "acceleration"), 0.3, _draw_presliding),
]
