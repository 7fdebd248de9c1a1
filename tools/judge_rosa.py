"""A real speed-controlled shaft over several random splits of its files.

    tools/judge_rosa.py PROGRAM DATA/rosa [--splits 5] [--seed 1] [--design 0.5]

Every split draws healthy files to `train` on; the others, and half of each kind of faulty files,
are judged by `diagnose --baseline` with about 4 s of the same recording's healthy part. Windows of
2 s count: a healthy one within a declaration is false, a faulty one within a declaration is found;
windows of both labels are left out. Nothing here is learned from the rig: the program gets files,
as it would from anyone.
"""

import argparse
import csv
import json
import math
import random
import subprocess
import tempfile
from collections import Counter
from pathlib import Path

WINDOW_S = 2.0
BASELINE_S = 4.2
SHORTEST_S = 0.9
# Speed below which the shaft counts as at rest, rpm.
TURNS = 40.0
KINDS = ("healthy", "N", "V", "D")


def read(file):
    """Header and rows of a file: (time, labelled healthy and turning, labelled healthy, text)."""
    lines = file.read_text().splitlines()
    rows = []
    for line in lines[1:]:
        values = next(csv.reader([line]))
        healthy = values[4] == "H"
        rows.append((float(values[0]), healthy and float(values[3]) > TURNS, healthy, line))
    return lines[0], rows


def baseline(rows):
    """First seconds of the longest healthy stretch; nothing where it is too short."""
    best, first = range(0), 0
    for k in range(len(rows) + 1):
        if k == len(rows) or not rows[k][1]:
            if k - first > len(best):
                best = range(first, k)
            first = k + 1
    if not best:
        return None
    start = rows[best.start][0]
    taken = [k for k in best if rows[k][0] < start + BASELINE_S]
    return range(taken[0], taken[-1] + 1) if rows[taken[-1]][0] - start >= SHORTEST_S else None


def put(path, header, rows):
    """Writes rows as a file."""
    path.write_text("\n".join([header, *(row[3] for row in rows)]) + "\n")


def diagnosed(program, folder, file, kind):
    """Declarations of a file and the rows that were judged; nothing where its baseline is none."""
    header, rows = read(file)
    of = baseline(rows)
    if of is None:
        return None
    put(folder / "baseline.csv", header, rows[of.start : of.stop])
    rest = rows[of.stop :] if kind == "healthy" else rows
    put(folder / "rest.csv", header, rest)
    asked = [program, "diagnose", "rig.toml", "rest.csv", "--baseline", "baseline.csv"]
    asked += ["--json", "-", "--quiet"]
    ran = subprocess.run(asked, cwd=folder, capture_output=True, text=True, check=False)
    if ran.returncode == 2 and "something changes" in ran.stderr:
        return None
    if ran.returncode != 0:
        raise SystemExit(f"{file}: {ran.stderr}")
    return json.loads(ran.stdout), rest


def windows(answer, rows):
    """(labelled healthy, within a declaration) of every window of one label."""
    end = rows[-1][0]
    spans = [
        (it["from"], it["to"] if it["to"] is not None else end) for it in answer["declarations"]
    ]
    begin = rows[0][0]
    while begin + WINDOW_S <= end:
        stop = begin + WINDOW_S
        labels = {row[2] for row in rows if begin <= row[0] < stop}
        if len(labels) == 1:
            yield labels.pop(), any(a < stop and b > begin for a, b in spans)
        begin = stop


def interval(hits, of):
    """95 % score interval of a share, per cent."""
    if of == 0:
        return math.nan, math.nan
    z, p = 1.959964, hits / of
    middle, half = p + z * z / (2 * of), z * math.sqrt(p * (1 - p) / of + z * z / (4 * of * of))
    scale = 1 + z * z / of
    return 100 * (middle - half) / scale, 100 * (middle + half) / scale


def told(what, hits, of, bar):
    """A line of the table."""
    low, high = interval(hits, of)
    share = 100 * hits / of if of else math.nan
    return f"{what}: {hits} of {of} = {share:.1f} % [{low:.1f}, {high:.1f}] (bar {bar})"


def judge(program, data, seed, share, counts):
    """Counts of one split."""
    draw = random.Random(seed)
    files = {kind: sorted((data / kind).glob("*.csv")) for kind in KINDS}
    healthy = files["healthy"][:]
    draw.shuffle(healthy)
    cut = round(share * len(healthy))
    design, judged = sorted(healthy[:cut]), {"healthy": healthy[cut:]}
    for kind in KINDS[1:]:
        judged[kind] = draw.sample(files[kind], len(files[kind]) // 2)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        train = [program, "train", *design, "-o", "rig.toml", "--without", "recurrent,gmdh"]
        subprocess.run([*train, "--quiet"], cwd=folder, check=True)
        for kind in KINDS:
            for file in judged[kind]:
                found = diagnosed(program, folder, file, kind)
                if found is None:
                    counts[kind, "refused"] += 1
                    continue
                answer, rows = found
                counts[kind, "files"] += 1
                counts[kind, "quiet"] += not answer["declarations"]
                marked = list(windows(answer, rows))
                for label, declared in marked:
                    counts[kind, "healthy" if label else "faulty"] += 1
                    counts[kind, "false" if label else "found"] += declared
                false = sum(declared for label, declared in marked if label)
                if false:
                    counts["where", f"{kind}/{file.stem}"] += false


def table(counts):
    """The figures beside their bars."""
    count = lambda kind, what: counts[kind, what]  # noqa: E731
    lines = [
        told("false windows", count("healthy", "false"), count("healthy", "healthy"), "2 %"),
        told(
            "files without an alarm", count("healthy", "quiet"), count("healthy", "files"), "94 %"
        ),
    ]
    for kind, bar in zip(KINDS[1:], ("97 %", "97 %", "80 %"), strict=True):
        lines.append(told(f"{kind} found", count(kind, "found"), count(kind, "faulty"), bar))
    within = [sum(count(kind, what) for kind in KINDS[1:]) for what in ("false", "healthy")]
    lines.append(told("false windows of faulty files", *within, "none"))
    refused = ", ".join(f"{kind} {count(kind, 'refused')}" for kind in KINDS)
    lines.append(f"baselines refused or missing: {refused}")
    return "\n".join(lines)


def main():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("data", type=Path)
    parser.add_argument("--splits", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--design", type=float, default=0.5)
    options = parser.parse_args()
    program, data = options.program.resolve(), options.data.resolve()
    total = Counter()
    for seed in range(options.seed, options.seed + options.splits):
        counts = Counter()
        judge(program, data, seed, options.design, counts)
        print(f"split of seed {seed}\n{table(counts)}\n")
        total.update(counts)
    print(f"all {options.splits} splits (files return in several: not independent)\n{table(total)}")
    where = sorted(
        ((n, name) for (kind, name), n in total.items() if kind == "where"), reverse=True
    )
    print("false windows by file: " + ", ".join(f"{name} {n}" for n, name in where[:12]))


if __name__ == "__main__":
    main()
