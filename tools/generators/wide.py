"""Cases over the width of the field: machines from 1 W to 10 kW, with gears and as linear axes,
driven by voltage or by current, at several operating points, sampled at 50 Hz to 20 kHz, seen by
several sensors, under loads of several kinds.

Machines with like sampling are stepped together on one clock, slower ones hold their input for
several of its ticks.
"""

from dataclasses import dataclass

import numpy as np

from . import channels, operating, sizes
from .axis import HIDDEN as OF_AXES
from .cases import CREEP, KINDS, START, Case, _bench, _gather, _sensed
from .control import Controllers
from .laws import catalogue
from .loads import KINDS as LOADS
from .loads import Loads
from .measuring import LEVELS, seen
from .stepping import run

CLOCKS = {
    # ticks of 1 ms in ten sub-steps, and of 50 us in one
    1e-3: ((50, 100, 200, 500, 1000), 10),
    5e-5: ((2000, 5000, 10_000, 20_000), 1),
}
"""Tick in s: rates in Hz that it serves, sub-steps."""
SLOW_SECONDS = 12.0
SECONDS = {1e-3: 8.0, 5e-5: 2.5}
"""How long a recording lasts; `SLOW_SECONDS` where there are few samples a second."""
SLOW_RATE = 100
TOGETHER = 100
"""Machines that are stepped together: their trace has to fit the memory."""
LOADED = 0.7
"""Share of the machines with a random load."""
LOAD = (0.005, 0.03)
"""Its standard deviation, a share of the rated torque."""
LOAD_TIME = (0.02, 0.4)
"""Its time, s."""
SMOOTH = 0.2
"""Share of the machines with the smoothed zero-speed law."""
KIND_SHARES = {"motor": 0.45, "gear": 0.15, "current": 0.2, "axis": 0.2}
BY_CURRENT = ("current", "axis")
ELECTRICAL = (
    *("brush_drop", "dead_time", "winding_heating", "supply_sag", "current_offset"),
    *("x_curved_resistance", "saturation", "armature_reaction", "delay"),
)
"""What a machine driven by its current does not show, or shows otherwise."""
OF_SPEED_SENSOR = ("speed_sensor_lag", "tacho_eccentricity", "tacho_gain")
SENSED_CURRENT = ("current_offset",)
NAMES = {
    "rotary": {"omega": "omega", "theta": "theta"},
    "linear": {"omega": "v", "theta": "x"},
}


@dataclass
class Plan:
    """What is to be made."""

    hidden: list
    """Name of what hides in each case, or None."""
    seed: int
    noise: str = "medium"
    size: float = 1.0
    lasts: float = 1.0
    """Factor on the usual length of the recordings."""


@dataclass
class _Drawn:
    """A case before it is run."""

    name: str
    hidden: str | None
    parameters: dict
    machine: object
    kind: str
    rate: int
    watts: float
    travel: float
    sensors: object
    points: dict
    asked: dict
    load: dict | None
    smooth: float
    seconds: float

    @property
    def by_current(self):
        return self.kind in BY_CURRENT

    @property
    def linear(self):
        return self.kind == "axis"


def _kinds(hidden):
    """Kinds of machines in which that can hide."""
    kinds = dict(KIND_SHARES)
    if hidden in ELECTRICAL:
        kinds = {name: share for name, share in kinds.items() if name not in BY_CURRENT}
    if hidden is not None and hidden not in OF_AXES:
        kinds.pop("axis", None)
    return list(kinds), np.array(list(kinds.values())) / sum(kinds.values())


def _suits(sensors, hidden):
    """Whether those sensors can show it."""
    if hidden in OF_SPEED_SENSOR:
        return sensors.speed_from == "sensor"
    return hidden not in SENSED_CURRENT or "i" in sensors.columns


def _draw(rng, k, hidden, law, plan):
    names, shares = _kinds(hidden)
    kind = names[rng.choice(len(names), p=shares)]
    rates = [rate for tick, (all_, _) in CLOCKS.items() for rate in all_]
    if hidden == "delay":
        # It is shorter than a tick of the slow clock.
        rates = list(CLOCKS[1e-3][0])
    rate = int(rng.choice(rates))
    period = 1.0 / rate
    m, watts = sizes.motor(rng)
    travel = 1.0
    if kind == "gear":
        m, gear = sizes.geared(rng, m)
        travel = 1.0 / gear
    elif kind == "axis":
        m, travel = sizes.axis(rng, m)
    tick = _tick(rate)
    seconds = plan.lasts * (SLOW_SECONDS if rate <= SLOW_RATE else SECONDS[tick])
    sensors = channels.draw(rng, kind not in BY_CURRENT, travel, period)
    while not _suits(sensors, hidden):
        sensors = channels.draw(rng, kind not in BY_CURRENT, travel, period)
    points = operating.BY_CURRENT if kind in BY_CURRENT else operating.BY_VOLTAGE
    point = points[rng.integers(len(points))]
    other = points[rng.integers(len(points))] if rng.random() < 0.3 else point
    t = np.arange(round(seconds * rate)) * period
    drawn = {of: (it, *it(rng, t, m)) for of, it in zip(KINDS, (point, other), strict=True)}
    parameters = law.draw(rng, m, plan.size * law.size) if law else {}
    if hidden == "cogging" and kind == "axis":
        # Of the teeth of its motor, over the travel of a radian.
        parameters["periods"] = parameters["periods"] / travel
    load = None
    if rng.random() < LOADED:
        load = {
            "kind": str(rng.choice(list(LOADS))),
            "sd": float(m.rated_torque * rng.uniform(*LOAD)),
            "time": float(rng.uniform(*LOAD_TIME)),
        }
    return _Drawn(
        name=f"case_{k:04d}",
        hidden=hidden,
        parameters={name: float(value) for name, value in parameters.items()},
        machine=m,
        kind=kind,
        rate=rate,
        watts=watts,
        travel=travel,
        sensors=sensors,
        points={of: it.__name__ for of, (it, _, _) in drawn.items()},
        asked={of: (mode, series) for of, (_, mode, series) in drawn.items()},
        load=load,
        smooth=float((rng.random() < SMOOTH) * m.top_speed * rng.uniform(*CREEP)),
        seconds=seconds,
    )


def _tick(rate):
    return next(tick for tick, (rates, _) in CLOCKS.items() if rate in rates)


def _truth(drawn, law, plan):
    m = drawn.machine
    names = ("K", "J", "B", "T_c") if drawn.linear else ("R", "L", "K", "J", "B", "T_c")
    return {
        "size": f"{drawn.watts:.3g} W",
        "watts": drawn.watts,
        "kind": drawn.kind,
        "motion": "linear" if drawn.linear else "rotary",
        "input": "current" if drawn.by_current else "voltage",
        "travel": drawn.travel,
        "machine": {name: float(getattr(m, name)) for name in names},
        "hidden": drawn.hidden,
        "fails_over": list(law.fails_over) if law else [],
        "in_library": bool(law.known) if law else None,
        "parameters": drawn.parameters,
        "noise_level": plan.noise,
        "load": drawn.load,
        "zero_speed": "smooth" if drawn.smooth else "stick",
        "operating": drawn.points,
        "rate_hz": drawn.rate,
        "columns": ["u", *drawn.sensors.columns],
        "speed_from": drawn.sensors.speed_from,
        "encoder_step": drawn.sensors.step,
        "skew_s": drawn.sensors.skew,
        "seed": plan.seed,
        "noise": {},
    }


def make(plan):
    """All cases of a plan. The same plan gives the same bytes."""
    laws = catalogue()
    rng = np.random.default_rng(plan.seed)
    all_ = [_draw(rng, k, id, laws.get(id), plan) for k, id in enumerate(plan.hidden)]
    cases = {}
    for drawn in all_:
        truth = _truth(drawn, laws.get(drawn.hidden), plan)
        machine = truth["machine"]
        off = {name: rng.choice([-1.0, 1.0]) * rng.uniform(*START) for name in machine}
        start = {name: float(value * (1.0 + off[name])) for name, value in machine.items()}
        if drawn.by_current:
            # From a current and a motion only ratios to K can be known.
            start["K"] = machine["K"]
        cases[drawn.name] = Case(
            drawn.name,
            truth,
            start,
            period=1.0 / drawn.rate,
            motion=truth["motion"],
            by_current=drawn.by_current,
        )
    for tick in CLOCKS:
        alike = [drawn for drawn in all_ if _tick(drawn.rate) == tick]
        for at in range(0, len(alike), TOGETHER):
            _run(rng, alike[at : at + TOGETHER], tick, plan, laws, cases)
    return [cases[drawn.name] for drawn in all_]


def _run(rng, some, tick, plan, laws, cases):
    """Both recordings of these machines, stepped together."""
    lanes = [(drawn, kind) for kind in KINDS for drawn in some]
    machines = sizes.together([drawn.machine for drawn, _ in lanes])
    every = np.array([round(1.0 / (drawn.rate * tick)) for drawn, _ in lanes])
    ticks = max(round(drawn.seconds / tick) for drawn in some)
    asked = np.zeros((ticks, len(lanes)))
    for lane, (drawn, kind) in enumerate(lanes):
        held = np.repeat(drawn.asked[kind][1], every[lane])[:ticks]
        asked[: len(held), lane] = held
    modes = np.array([drawn.asked[kind][0] for drawn, kind in lanes])
    force = np.array([drawn.by_current for drawn, _ in lanes])
    hidden = _gather([(drawn.hidden, drawn.parameters) for drawn, _ in lanes], laws)
    bench = _bench(machines, hidden, laws, np.array([drawn.smooth for drawn, _ in lanes]))
    bench.force = force if force.any() else False
    loads = [drawn.load or {"kind": None, "sd": 0.0, "time": 1.0} for drawn, _ in lanes]
    sd, slow = (np.array([load[name] for load in loads]) for name in ("sd", "time"))
    load = Loads(rng, [load["kind"] for load in loads], sd, slow, tick)
    share = LEVELS[plan.noise][0]
    control = Controllers(machines, force, modes, asked, every, tick, share, rng)
    delay = hidden.get("delay", {}).get("delay")
    trace = run(bench, control, load, tick, delay, CLOCKS[tick][1])
    shown = seen(trace, _sensed(hidden, len(lanes)))
    for lane, (drawn, kind) in enumerate(lanes):
        rows = slice(0, round(drawn.seconds / tick), int(every[lane]))
        signals = {name: values[rows, lane] for name, values in shown.items()}
        signals["u"] = trace.u[rows, lane]
        t = np.arange(len(signals["u"])) / drawn.rate
        case = cases[drawn.name]
        names = NAMES[case.motion]
        made = channels.seen(rng, t, signals, drawn.sensors, plan.noise, names)
        case.recordings[kind], case.truth["noise"][kind] = made
