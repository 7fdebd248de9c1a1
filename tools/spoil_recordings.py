#!/usr/bin/env python3
"""Makes recordings spoiled in the ways of the world's loggers, with the truth beside each.

    python tools/spoil_recordings.py OUT [--cases N] [--seed S] [--spoilings NAME,...]

Every case is a file `KIND_K.csv` with one to four spoilings, drawn from the list or from those
named; `KIND_K.truth.json` says which, and holds the clean signals as functions of time;
`KIND_K.truth.npz` holds instant, stamp, run and values of every row.
"""

import argparse
from pathlib import Path

import numpy as np
from spoiling import drawing, files
from spoiling.clean import KINDS


def make(folder, cases, seed, allowed=drawing.ALL):
    """Writes so many spoiled files; their paths. Case k depends on seed and k alone."""
    kinds = list(KINDS)
    paths = []
    for k in range(cases):
        rng = np.random.default_rng([seed, k])
        kind = kinds[k % len(kinds)]
        draft = drawing.draft(rng, kind, drawing.draw(rng, allowed))
        paths.append(files.write(folder, f"{kind}_{k:04d}", draft))
    assert len(set(paths)) == cases, "a file was written twice"
    return paths


def spoilings(text):
    """The spoilings that a command line names."""
    named = text.split(",")
    for name in named:
        if name not in drawing.ALL:
            known = ", ".join(drawing.ALL)
            raise argparse.ArgumentTypeError(f"no spoiling called `{name}`; known: {known}")
    return named


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--spoilings", type=spoilings, default=drawing.ALL)
    options = parser.parse_args()
    made = make(options.out, options.cases, options.seed, options.spoilings)
    print(f"{len(made)} files in {options.out}")


if __name__ == "__main__":
    main()
