"""Force-driven linear axes: a carriage under position control, of which only x is measured.

u is the voltage at a current amplifier that is far faster than the mechanics, so u K is the force.
A sampled controller (position, speed by difference) follows smooth moves there and back.
"""

import numpy as np

from .balance import THETA, Bench
from .cases import KINDS, Case, _gather
from .laws import catalogue
from .machine import Machine
from .measuring import ColouredLoad
from .stepping import SUBSTEPS, run

MIDDLE = {"K": 35.0, "J": 95.0, "B": 200.0, "T_c": 20.0}
NOISE = {"none": 0.0, "small": 1e-6, "medium": 4e-6, "large": 1.5e-5}
"""Standard deviation of x, m."""
HIDDEN = ("asymmetric_friction", "stribeck", "quadratic_drag", "cogging", "constant_load")
"""What can hide in an axis without an armature circuit."""


def _machines(rng, count):
    spread = {name: np.exp(0.2 * rng.standard_normal(count)) * v for name, v in MIDDLE.items()}
    one = np.ones(count)
    # The top speed of the laws is volts / K: 0.3 m/s here; the rating 60 N.
    return Machine(
        volts=0.3 * spread["K"],
        R=one,
        L=one,
        K=spread["K"],
        J=spread["J"],
        B=spread["B"],
        T_c=spread["T_c"],
        amps=60.0 / spread["K"],
    )


def _moves(rng, samples, period):
    """A path of smooth moves: minimum-jerk polynomials and rests, m."""
    path, here = [], 0.0
    while sum(map(len, path)) < samples:
        there = rng.uniform(-0.12, 0.12)
        length = int(max(0.25, abs(there - here) / rng.uniform(0.05, 0.2)) / period)
        x = np.arange(1, length + 1) / length
        path.append(here + (there - here) * x**3 * (10 - 15 * x + 6 * x**2))
        path.append(np.full(int(rng.uniform(0.05, 0.2) / period), there))
        here = there
    return np.concatenate(path)[:samples]


class Controller:
    """u from the measured position: 30 rad/s of stiffness and as much damping."""

    def __init__(self, machines, path, period, sd, rng):
        self.samples = len(path)
        self.m, self.path, self.period, self.sd, self.rng = machines, path, period, sd, rng
        self.before = None
        self.measured = np.empty_like(path)

    def __call__(self, k, x):
        seen = x[THETA] + self.sd * self.rng.standard_normal(x.shape[1])
        self.measured[k] = seen
        speed = 0.0 if self.before is None else (seen - self.before) / self.period
        self.before = seen
        ahead = self.path[min(k + 1, self.samples - 1)] - self.path[k]
        rate = 30.0
        pull = rate**2 * (self.path[k] - seen) + 2 * rate * (ahead / self.period - speed)
        return np.clip(self.m.J * pull / self.m.K, -10.0, 10.0)


def make(hidden, seed, noise="medium", coloured=False, samples=8000, period=1e-3):
    """Cases of axes; `hidden` as in `cases.Plan`."""
    laws, count = catalogue(), len(hidden)
    rng = np.random.default_rng(seed)
    machines = _machines(rng, count)
    drawn = []
    for k, id in enumerate(hidden):
        parameters = laws[id].draw(rng, machines.take(k), laws[id].size) if id else {}
        if id == "cogging":
            # A spatial period of 1 to 4 mm in place of periods a revolution.
            parameters["periods"] = 2 * np.pi / rng.uniform(1e-3, 4e-3)
        drawn.append((id, {name: float(value) for name, value in parameters.items()}))
    gathered = _gather(drawn, laws)
    bench = Bench(
        machine=machines,
        laws=[(laws[id].add, p) for id, p in gathered.items()],
        creep=np.zeros(count),
        force=True,
    )
    load_sd = np.full(count, 1.5 if coloured else 0.0)
    load_time = rng.uniform(0.03, 0.2, size=count)
    off = 1.0 + rng.choice([-1.0, 1.0], size=(3, count)) * rng.uniform(0.1, 0.2, size=(3, count))
    cases = []
    for k, (id, parameters) in enumerate(drawn):
        m = machines.take(k)
        truth = {
            "machine": {name: float(getattr(m, name)) for name in ("K", "J", "B", "T_c")},
            "hidden": id,
            "fails_over": list(laws[id].fails_over) if id else [],
            "in_library": True if id else None,
            "parameters": parameters,
            "load": {"sd": float(load_sd[k]), "time": float(load_time[k])} if coloured else None,
            "noise": {},
            "seed": seed,
        }
        # K stays as it is: from u and x only ratios to it can be known.
        start = {"K": float(m.K)}
        start |= {
            name: float(getattr(m, name) * off[j, k]) for j, name in enumerate(("J", "B", "T_c"))
        }
        cases.append(Case(f"axis_{k:04d}", truth, start, period=period, motion="linear"))
    for kind in KINDS:
        path = np.stack([_moves(rng, samples, period) for _ in cases], axis=1)
        controller = Controller(machines, path, period, NOISE[noise], rng)
        load = ColouredLoad(rng, load_sd, load_time, period / SUBSTEPS)
        trace = run(bench, controller, load, period)
        for k, case in enumerate(cases):
            case.recordings[kind] = {"u": trace.u[:, k], "x": controller.measured[:, k]}
            case.truth["noise"][kind] = {"x": NOISE[noise]}
    return cases
