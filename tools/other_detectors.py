"""Other people's one-class detectors on the recordings of `benchmark detection --keep DIR`.

    tools/other_detectors.py DIR [--json FILE]

PyOD's PCA (what a linear autoencoder learns), one-class SVM and ECOD, and an autoencoder of
scikit-learn, learn the healthy design runs: windows of 20 samples, mean and spread of C_m, T, I_m,
each channel less its mean over the machine's own healthy baseline, as our detectors have it. Limits
are the scores that healthy runs exceed once in so many samples, from half of the healthy machines;
false alarms are counted on the other half; delays are those of the runs that our detectors were
measured on.

Needs tools/requirements-other.txt.
"""

import argparse
import json
import math
from pathlib import Path

import numpy as np
from pyod.models.ecod import ECOD
from pyod.models.ocsvm import OCSVM
from pyod.models.pca import PCA
from sklearn.neural_network import MLPRegressor

WINDOW = 20
# Samples of a baseline in which a run settles from rest.
SETTLED = 500
ARL_0 = (1e3, 1e4)
# Samples after which an exceedance is another alarm.
APART = 400
LEARNED = 4000
SEED = 1


class Autoencoder:
    """A bottleneck of two between six features; the score is the squared error of its output."""

    def fit(self, x):
        """Learns healthy windows."""
        sizes = (8, 2, 8)
        self.net = MLPRegressor(
            hidden_layer_sizes=sizes, activation="tanh", max_iter=400, random_state=SEED
        )
        self.net.fit(x, x)
        return self

    def decision_function(self, x):
        """Higher is stranger."""
        return ((self.net.predict(x) - x) ** 2).sum(axis=1)


METHODS = {
    "PCA (pyod)": lambda: PCA(n_components=3, random_state=SEED),
    "ECOD (pyod)": ECOD,
    "one-class SVM (pyod)": lambda: OCSVM(nu=0.01, cache_size=500),
    "autoencoder (scikit-learn)": Autoencoder,
}


def runs(folder, file):
    """The runs of a file, an array of C_m, T, I_m each."""
    table = np.loadtxt(folder / file["file"], delimiter=",", skiprows=1)
    starts = np.flatnonzero(np.diff(table[:, 0])) + 1
    return np.split(table[:, 1:], starts)


def windows(run, baseline):
    """Means and spreads of all windows of a run after its baseline, row k ending at sample k."""
    settled = run[min(SETTLED, baseline // 2) : baseline]
    rest = run[baseline - WINDOW + 1 :] - settled.mean(axis=0)
    view = np.lib.stride_tricks.sliding_window_view(rest, WINDOW, axis=0)
    return np.hstack([view.mean(axis=2), view.std(axis=2)])


def alarms(scores, limit):
    """Alarms of a run, each a while after the one before; one that never ends counts again."""
    over = np.flatnonzero(scores > limit)
    count, place = 0, 0
    while place < over.size:
        count += 1
        place = np.searchsorted(over, over[place] + APART)
    return count


def limit_for(healthy, arl_0):
    """The score that healthy runs exceed about once in so many samples."""
    samples = sum(map(len, healthy))
    low, high = np.min(healthy[0]), max(map(np.max, healthy)) + 1e-9
    for _ in range(60):
        middle = 0.5 * (low + high)
        count = sum(alarms(scores, middle) for scores in healthy)
        low, high = (middle, high) if count > samples / arl_0 else (low, middle)
    return high


def interval(hits, of):
    """95 % score interval of a share."""
    z, p = 1.959964, hits / of
    half = z * math.sqrt(p * (1 - p) / of + z * z / (4 * of * of))
    return [(p + z * z / (2 * of) + sign * half) / (1 + z * z / of) for sign in (-1, 1)]


def faulty(scores, onsets, baseline, limit):
    """Shares detected without an alarm before, and mean delay."""
    delays = []
    for run, onset in zip(scores, onsets, strict=True):
        start = onset - baseline
        after = np.flatnonzero(run[start:] > limit)
        if after.size and not (run[:start] > limit).any():
            delays.append(int(after[0]))
    mean = float(np.mean(delays)) if delays else None
    error = float(np.std(delays) / math.sqrt(len(delays))) if delays else None
    share = len(delays) / len(onsets)
    low_high = interval(len(delays), len(onsets))
    return {"detected": share, "interval": low_high, "delay": mean, "delay_error": error}


def main():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    manifest = json.loads((options.folder / "manifest.json").read_text())
    baseline = manifest["baseline"]
    files = {kind: [] for kind in ("design", "healthy", "fault")}
    for file in manifest["files"]:
        made = [windows(run, baseline) for run in runs(options.folder, file)]
        files[file["kind"]].append((file, made))
    design = np.vstack([made for _, all_made in files["design"] for made in all_made])
    draw = np.random.default_rng(SEED)
    design = design[draw.choice(len(design), min(LEARNED, len(design)), replace=False)]
    scale = (design.mean(axis=0), design.std(axis=0))
    standard = lambda x: (x - scale[0]) / scale[1]  # noqa: E731
    found = {}
    for name, method in METHODS.items():
        model = method()
        model.fit(standard(design))
        score = lambda x: np.asarray(model.decision_function(standard(x)))  # noqa: B023, E731
        healthy = [score(made) for _, all_made in files["healthy"] for made in all_made]
        half = len(healthy) // 2
        fresh = healthy[half:]
        samples = sum(map(len, fresh))
        scores = [(file, [score(made) for made in all_made]) for file, all_made in files["fault"]]
        found[name] = []
        print(name)
        for arl_0 in ARL_0:
            limit = limit_for(healthy[:half], arl_0)
            false = sum(alarms(run, limit) for run in fresh)
            row = {"arl_0": arl_0, "false_alarms": false, "samples": samples, "faults": []}
            told = []
            for file, run_scores in scores:
                of = faulty(run_scores, file["onsets"], baseline, limit)
                row["faults"].append({"mechanism": file["mechanism"], "size": file["size"], **of})
                delay = "never" if of["delay"] is None else f"{of['delay']:.1f}"
                told.append(f"{file['mechanism']} {delay} ({100 * of['detected']:.0f} %)")
            print(f"  {arl_0:.0e}: {false} false alarms in {samples}; " + ", ".join(told))
            found[name].append(row)
    if options.json:
        options.json.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
