"""Cases: machines, what hides in each, and the recordings of all of them, made together."""

from dataclasses import dataclass, field

import numpy as np

from . import excitation, machine
from .balance import Bench
from .laws import catalogue
from .measuring import LEVELS, ColouredLoad, noisy, seen
from .stepping import SUBSTEPS, run

KINDS = ("estimation", "validation")
SENSED = ("lag", "gain", "depth", "phase", "offset")
"""What sensors do, by the names of their parameters."""
LOAD = (0.01, 0.03)
"""Standard deviation of a coloured load, share of the rated torque; drawn in between."""
LOAD_TIME = (0.02, 0.2)
"""Its time constant, s."""
CREEP = (2e-4, 6e-4)
"""Width of the smoothed zero-speed law, share of the top speed: below what the sensors resolve."""
START = (0.1, 0.2)
"""How far the start values of the drive file are off."""


@dataclass
class Plan:
    """What is to be made."""

    hidden: list
    """Name of what hides in each case, or None."""
    seed: int
    noise: str = "medium"
    coloured: list | bool = False
    """Whether a case has a random load torque."""
    smooth: list | bool = False
    """Whether the zero-speed law is the smoothed one."""
    size: float = 1.0
    """Factor on the usual size of what hides."""
    samples: int = 8000
    period: float = 1e-3


@dataclass
class Case:
    """One machine and its recordings."""

    name: str
    truth: dict
    start: dict
    """Parameters of the drive file: off by 10 to 20 %."""
    recordings: dict = field(default_factory=dict)
    """By kind: columns by name."""
    period: float = 1e-3
    """Sampling time, s."""
    motion: str = "rotary"
    by_current: bool = False
    """Whether u is the current, A."""


def _each(flag, count):
    return np.broadcast_to(np.asarray(flag, dtype=bool), (count,))


def _gather(drawn, laws):
    """Parameters of every law that hides somewhere, as arrays over the cases."""
    gathered = {}
    for law in laws.values():
        members = [k for k, (id, _) in enumerate(drawn) if id == law.id]
        if not members:
            continue
        names = drawn[members[0]][1]
        arrays = {name: np.full(len(drawn), float(law.neutral.get(name, 0.0))) for name in names}
        for k in members:
            for name, value in drawn[k][1].items():
                arrays[name][k] = value
        gathered[law.id] = arrays
    return gathered


def _bench(machines, hidden, laws, creep):
    bench = Bench(
        machine=machines,
        laws=[(laws[id].add, p) for id, p in hidden.items() if laws[id].add is not None],
        creep=creep,
    )
    zero = np.zeros(len(creep))
    if "presliding" in hidden:
        bench.bristle = hidden["presliding"]["bristle"]
        bench.creep = np.where(bench.bristle > 0.0, 0.0, creep)
    if "winding_heating" in hidden:
        p = hidden["winding_heating"]
        bench.heating = (p["rise"], p["slow"])
    far = [hidden[id] for id in ("flexible_coupling", "backlash") if id in hidden]
    if far:
        names = ("share", "stiffness", "damping", "play")
        bench.far = tuple(sum((p[name] for p in far), zero) for name in names)
    if "speed_sensor_lag" in hidden:
        bench.lag = hidden["speed_sensor_lag"]["lag"]
    return bench


def _sensed(hidden, count):
    ids = ("speed_sensor_lag", "tacho_eccentricity", "current_offset", "tacho_gain")
    values = {name: np.zeros(count) for name in SENSED}
    for id in ids:
        for name, array in hidden.get(id, {}).items():
            values[name] = values[name] + array
    return values


def make(plan, substeps=SUBSTEPS):
    """All cases of a plan. The same plan gives the same bytes."""
    laws = catalogue()
    count = len(plan.hidden)
    rng = np.random.default_rng(plan.seed)
    machines, sizes = machine.draw(rng, count)
    drawn = []
    for k, id in enumerate(plan.hidden):
        law = laws.get(id)
        parameters = law.draw(rng, machines.take(k), plan.size * law.size) if law else {}
        drawn.append((id, {name: float(value) for name, value in parameters.items()}))
    hidden = _gather(drawn, laws)
    smooth, coloured = _each(plan.smooth, count), _each(plan.coloured, count)
    creep = np.where(smooth, machines.top_speed * rng.uniform(*CREEP, size=count), 0.0)
    load_sd = np.where(coloured, machines.rated_torque * rng.uniform(*LOAD, size=count), 0.0)
    load_time = rng.uniform(*LOAD_TIME, size=count)
    off = 1.0 + rng.choice([-1.0, 1.0], size=(6, count)) * rng.uniform(*START, size=(6, count))
    cases = []
    for k, (id, parameters) in enumerate(drawn):
        law, m = laws.get(id), machines.take(k)
        names = ("R", "L", "K", "J", "B", "T_c")
        values = {name: float(getattr(m, name)) for name in names}
        truth = {
            "size": sizes[k],
            "machine": values,
            "hidden": id,
            "fails_over": list(law.fails_over) if law else [],
            "in_library": bool(law.known) if law else None,
            "parameters": parameters,
            "noise_level": plan.noise,
            "load": {"sd": float(load_sd[k]), "time": float(load_time[k])} if coloured[k] else None,
            "zero_speed": "smooth" if smooth[k] else "stick",
            "seed": plan.seed,
            "noise": {},
        }
        start = {name: values[name] * float(off[j, k]) for j, name in enumerate(names)}
        cases.append(Case(f"case_{k:04d}", truth, start, period=plan.period))
    # Both recordings of all machines in one go: numpy's cost is in the calls, not in the lanes.
    lanes = range(count * len(KINDS))
    shares = [excitation.voltage(rng, plan.samples, plan.period) for _ in lanes]
    both = np.tile(np.arange(count), len(KINDS))
    u = np.round(np.stack(shares, axis=1) * machines.volts[both], 3)
    wide = {id: {name: array[both] for name, array in p.items()} for id, p in hidden.items()}
    bench = _bench(machines.take(both), wide, laws, creep[both])
    load = ColouredLoad(rng, load_sd[both], load_time[both], plan.period / substeps)
    delay = wide.get("delay", {}).get("delay")
    trace = run(bench, u, load, plan.period, delay, substeps)
    signals = seen(trace, _sensed(wide, len(both)))
    for lane in lanes:
        case, kind = cases[lane % count], KINDS[lane // count]
        speed, current = LEVELS[plan.noise]
        omega, omega_sd = noisy(rng, signals["omega"][:, lane], speed)
        i, i_sd = noisy(rng, signals["i"][:, lane], current)
        case.recordings[kind] = {"u": u[:, lane], "i": i, "omega": omega}
        case.truth["noise"][kind] = {"i": i_sd, "omega": omega_sd}
    return cases
