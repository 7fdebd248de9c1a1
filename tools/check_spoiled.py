#!/usr/bin/env python3
"""How many spoiled recordings are refused or read wrongly: none should be.

    python tools/check_spoiled.py [--cases N] [--seed S] [--spoilings NAME,...] [--keep DIR]
                                  [--program FILE] [--rows N]

Makes spoiled files (tools/spoil_recordings.py), reads all of them with `recording/examples/
convert.rs` in one process, and compares every sample with the truth within stated errors
(spoiling/judging.py). Printed are the outcomes by spoiling, the files that failed with the first
reason, and how long reading `--rows` rows with jitter takes (best of three). Exit status 1 if any
file was refused, read wrongly or made the reader panic; then the files are kept.
"""

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from spoil_recordings import make, spoilings
from spoiling import drawing, files, judging

ROOT = Path(__file__).resolve().parent.parent
# With the features that the Rust tests ask for, so that nothing is compiled twice.
BUILD = "cargo build --quiet --locked --release --workspace --all-features --example convert"
LONGEST_RUN_S = 900.0
BAD = ["refused", "wrong", "panic"]


def built():
    """The program that reads a list of files."""
    subprocess.run(BUILD.split(), cwd=ROOT, check=True)
    return ROOT / "target/release/examples/convert"


def convert(program, folder, paths):
    """Runs the program over the files; it says in JSON what became of each, now and not before."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    command = [program, folder, *paths]
    subprocess.run(command, stderr=subprocess.DEVNULL, timeout=LONGEST_RUN_S)


def check(program, folder, cases, seed, allowed=drawing.ALL):
    """Verdicts by file, and the truth of each."""
    paths = make(folder / "spoiled", cases, seed, allowed)
    convert(program, folder / "read", paths)
    outcomes = []
    for path in paths:
        truth = files.load(path)
        verdict = judging.judge(truth, judging.load(folder / "read", path.name))
        outcomes.append((path, truth, verdict))
    return outcomes


def told(outcomes):
    """Prints the table and the failures; how many there are."""
    print(f"{'spoiling':<22}{'cases':>7}" + "".join(f"{kind:>9}" for kind in BAD))
    names = [name for name in drawing.ALL if any(name in it[1]["spoilings"] for it in outcomes)]
    for name in [*names, "all"]:
        own = [it[2].kind for it in outcomes if name == "all" or name in it[1]["spoilings"]]
        counts = "".join(f"{own.count(kind) or '':>9}" for kind in BAD)
        print(f"{name:<22}{len(own):>7}{counts}")
    failed = [it for it in outcomes if it[2].kind != "right"]
    for path, truth, verdict in failed:
        print(f"{verdict.kind}: {path}: {', '.join(truth['spoilings'])}\n    {verdict.reasons[0]}")
    return len(failed)


def time_reading(program, folder, rows):
    """Seconds to read so many rows with jitter, best of three."""
    rng = np.random.default_rng(1)
    t = 1e-3 * (np.arange(rows) + rng.uniform(-0.3, 0.3, rows))
    columns = [t, np.sign(np.sin(t)), 3.0 * np.sin(2.0 * t), 200.0 * np.sin(1.5 * t)]
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "jitter.csv"
    head = "time [s],u [V],i [A],omega [rad/s]"
    np.savetxt(path, np.column_stack(columns), "%.6f", ",", header=head, comments="")
    seconds = []
    for _ in range(3):
        convert(program, folder / "read", [path])
        account = json.loads((folder / "read" / f"{path.name}.json").read_text("utf-8"))
        seconds.append(account["read_s"])
    return min(seconds)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--spoilings", type=spoilings, default=drawing.ALL)
    parser.add_argument("--keep", type=Path, help="a folder for the files")
    parser.add_argument("--program", type=Path, help="the built example `convert`")
    parser.add_argument("--rows", type=int, default=1_000_000, help="0: nothing is timed")
    options = parser.parse_args()
    program = options.program or built()
    folder = options.keep or Path(tempfile.mkdtemp(prefix="spoiled-"))
    failures = told(check(program, folder, options.cases, options.seed, options.spoilings))
    if options.rows:
        seconds = time_reading(program, folder / "timed", options.rows)
        print(f"reading {options.rows} rows with jitter: {seconds:.2f} s")
    if failures == 0 and options.keep is None:
        shutil.rmtree(folder)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
