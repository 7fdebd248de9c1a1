#!/usr/bin/env python3
"""How often spoiled signals are found, and how often good ones are doubted: that should be never.

    python tools/check_signals.py [--cases N] [--seed S] [--with DRIVE REC ...] [--program FILE]
                                  [--make OPTIONS] [--spoiled N] [--spoilings NAME,...] [--all]

Makes good recordings of machines (tools/make_recordings.py), and takes those that are named beside
a drive file. All are looked at with `discovery/examples/signals.rs`: none may be found unusable or
repaired. Of the first `--spoiled` recordings every kind of spoiling (spoiling/signals.py) is made
as well, and counted how often it is found. Rates have their 95 % interval (Wilson). Exit status 1
if a good recording was doubted.
"""

import argparse
import collections
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from spoiling import signals

ROOT = Path(__file__).resolve().parent.parent
BUILD = "cargo build --quiet --locked --release -p drivescope-discovery --example signals"
LIMITS = "limits"


def wilson(hits, of, z=1.96):
    """The 95 % interval of a rate."""
    if of == 0:
        return 0.0, 1.0
    rate, scale = hits / of, 1.0 + z * z / of
    half = z * np.sqrt(rate * (1 - rate) / of + z * z / (4 * of * of)) / scale
    middle = (rate + z * z / (2 * of)) / scale
    return max(0.0, middle - half), min(1.0, middle + half)


def looked_at(program, drive, files):
    """What is found in each file."""
    run = subprocess.run([program, drive, *files], capture_output=True, text=True, check=True)
    return [json.loads(line) for line in run.stdout.splitlines()]


def grave(found):
    """What is more than a limit of what can be told."""
    if "refused" in found:
        return ["refused"]
    return [it["what"] for it in found["signals"] if it["consequence"] != LIMITS]


def kinds(found):
    return {"refused"} if "refused" in found else {it["what"] for it in found["signals"]}


def good_ones(program, sets, told):
    """How many good recordings are doubted; what limits are told is only counted."""
    doubted, count, limits = [], 0, collections.Counter()
    for drive, files in sets:
        for found in looked_at(program, drive, files):
            count += 1
            limits.update(kinds(found))
            if grave(found):
                doubted.append((found["file"], grave(found)))
                if told:
                    print("   ", found["file"], json.dumps(found))
    low, high = wilson(len(doubted), count)
    print(f"good: {len(doubted)} of {count} doubted, {100 * low:.2f} to {100 * high:.2f} %")
    for file, what in doubted:
        print("   ", file, what)
    print("    told of them:", dict(limits))
    return doubted


def spoiled_ones(program, sets, folder, seed, names, told):
    """How often each spoiling is found."""
    for name in names:
        spoil, expected = signals.SPOILINGS[name]
        rng = np.random.default_rng(seed)
        hits, of, missed = 0, 0, []
        for drive, files in sets:
            tables = [signals.load(file) for file in files]
            for k, (file, table) in enumerate(zip(files, tables, strict=True)):
                other = tables[k - 1] if len(tables) > 1 else None
                made = spoil(table, other, rng)
                if made is None:
                    continue
                path = folder / f"{Path(file).stem}.csv"
                signals.save(path, made)
                [found] = looked_at(program, drive, [path])
                of += 1
                hit = bool(kinds(found) & expected)
                hits += hit
                if not hit:
                    missed.append((file, sorted(kinds(found))))
        low, high = wilson(hits, of)
        rate = f"{hits} of {of}"
        print(f"{name:18} {rate:>11} found, {100 * low:5.1f} to {100 * high:5.1f} %", flush=True)
        if told:
            for file, what in missed:
                print("    missed:", file, what)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--with", dest="beside", nargs="+", action="append", default=[])
    parser.add_argument("--program", type=Path)
    parser.add_argument("--make", default="", help="of make_recordings.py, as in --make=--wide")
    parser.add_argument("--spoiled", type=int, default=20, help="recordings that are spoiled")
    parser.add_argument("--spoilings", default=",".join(signals.SPOILINGS))
    parser.add_argument("--all", action="store_true", help="show every finding and every miss")
    options = parser.parse_args()
    program = options.program
    if program is None:
        subprocess.run(BUILD.split(), cwd=ROOT, check=True)
        program = ROOT / "target/release/examples/signals"
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        sets = [(drive, files) for drive, *files in options.beside]
        if options.cases:
            made = [sys.executable, ROOT / "tools/make_recordings.py", folder / "made"]
            made += ["--cases", str(options.cases), "--seed", str(options.seed)]
            subprocess.run(made + options.make.split(), check=True, stdout=subprocess.DEVNULL)
            for case in sorted(it.parent for it in (folder / "made").glob("*/drive.toml")):
                files = [str(case / f"{name}.csv") for name in ("estimation", "validation")]
                sets.append((str(case / "drive.toml"), files))
        doubted = good_ones(program, sets, options.all)
        some, left = [], options.spoiled
        for drive, files in sets:
            some.append((drive, files[:left]))
            left -= len(files[:left])
        some = [(drive, files) for drive, files in some if files]
        spoiled_ones(program, some, folder, options.seed, options.spoilings.split(","), options.all)
    sys.exit(1 if doubted else 0)


if __name__ == "__main__":
    main()
