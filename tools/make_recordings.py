#!/usr/bin/env python3
"""Makes recordings of machines that drivescope did not simulate, with the truth beside them.

    python tools/make_recordings.py OUT [--hidden ID|none,...|all|library] [--cases N] [--seed S]

Every case is a folder: drive.toml (motor and Coulomb friction, start values 10 to 20 % off),
estimation.csv, validation.csv, truth.json. Cases take what hides in them in turn from the list.
With --wide every case draws its own kind and size of machine, operating point, sampling rate,
sensors and load, which truth.json tells; --coloured, --smooth, --motion and --seconds are of the
others.
"""

import argparse
import json
import sys
from pathlib import Path

from generators import axis, cases, files, wide
from generators.laws import catalogue
from generators.measuring import LEVELS


def hidden_list(text, count, motion):
    """What hides in each case."""
    known = catalogue()
    visible = [law.id for law in known.values() if law.fails_over]
    names = {"all": visible, "library": [id for id in visible if known[id].known]}.get(text)
    names = names or text.split(",")
    if motion == "linear":
        names = [name for name in names if name in axis.HIDDEN] if text == "all" else names
    allowed = ["none", *(axis.HIDDEN if motion == "linear" else known)]
    for name in names:
        if name not in allowed:
            sys.exit(f"nothing called `{name}` can hide here; known: {', '.join(allowed)}")
    hidden = [None if name == "none" else name for name in names]
    return [hidden[k % len(hidden)] for k in range(count)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--hidden", default="all", help="ids or `none`, `all`, `library`")
    parser.add_argument("--cases", type=int, default=24)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--noise", choices=LEVELS, default="medium")
    parser.add_argument("--coloured", action="store_true", help="a random load torque in each")
    parser.add_argument("--smooth", action="store_true", help="another zero-speed law: tanh")
    parser.add_argument("--size", type=float, default=1.0, help="factor on the usual sizes")
    parser.add_argument("--motion", choices=("rotary", "linear"), default="rotary")
    parser.add_argument(
        "--wide",
        action="store_true",
        help="machines from 1 W to 10 kW, geared, linear, current-driven; many operating points, "
        "sampling rates, sensors and loads",
    )
    parser.add_argument("--columns", help="keep these columns only, as in `u,omega`")
    parser.add_argument("--seconds", type=float, default=8.0)
    options = parser.parse_args()
    if options.cases < 1 or options.seconds < 1.0:
        parser.error("at least one case of one second")
    hidden = hidden_list(options.hidden, options.cases, options.motion)
    period = 1e-3
    samples = round(options.seconds / period)
    columns = options.columns.split(",") if options.columns else None
    if options.wide:
        made = wide.make(wide.Plan(hidden, options.seed, options.noise, options.size))
    elif options.motion == "linear":
        made = axis.make(hidden, options.seed, options.noise, options.coloured, samples, period)
    else:
        plan = cases.Plan(
            hidden,
            options.seed,
            options.noise,
            options.coloured,
            options.smooth,
            options.size,
            samples,
            period,
        )
        made = cases.make(plan)
    for case in made:
        files.write(case, options.out, columns)
    index = [{"case": case.name, "hidden": case.truth["hidden"]} for case in made]
    files.replace(options.out / "index.json", json.dumps(index, indent=1) + "\n")
    print(f"{len(made)} cases in {options.out}")


if __name__ == "__main__":
    main()
