"""Spoiled recordings are read as they were meant, and a reading a little wrong is found."""

import copy
import shutil
import tempfile
import unittest
from pathlib import Path

import numpy as np
from check_spoiled import built, check
from spoiling import judging

CASES = 60
SEED = 15


def smooth(truth):
    """The first signal that is no input, and its largest value."""
    signal = next(it for it in truth["signals"] if not it["held"])
    return signal["name"], signal["of"].largest()


def scaled(truth, columns):
    name, _ = smooth(truth)
    columns[name] = 1.01 * columns[name]


def shifted(truth, columns):
    name, _ = smooth(truth)
    columns[name] = np.roll(columns[name], 1)


def input_shifted(truth, columns):
    for signal in truth["signals"]:
        if signal["held"]:
            columns[signal["name"]] = np.roll(columns[signal["name"]], 2)
            return
    shifted(truth, columns)


def offset(truth, columns):
    name, largest = smooth(truth)
    columns[name] = columns[name] + 0.01 * largest


def outlying(truth, columns):
    name, largest = smooth(truth)
    columns[name] = columns[name].copy()
    columns[name][len(columns[name]) // 2] += 0.1 * largest


def lost(truth, columns):
    """A value is missing for good."""
    name, _ = smooth(truth)
    columns[name] = columns[name].copy()
    columns[name][len(columns[name]) // 2 :][:3] = np.nan


def late(truth, columns):
    """The whole recording begins later."""
    columns["time"] = columns["time"] + 100.0


def slow(truth, columns):
    """The clock is slow by one in a hundred."""
    start = columns["time"][0]
    columns["time"] = start + 1.01 * (columns["time"] - start)


def cut(truth, columns):
    """The end is missing."""
    for name in columns:
        columns[name] = columns[name][:-4]


WRONG = [scaled, shifted, input_shifted, offset, outlying, lost, late, slow, cut]


class Spoiled(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="spoiled-"))
        cls.outcomes = check(built(), cls.folder, CASES, SEED)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def test_every_file_is_read_as_it_was_meant(self):
        self.assertEqual(len(self.outcomes), CASES)
        for path, truth, verdict in self.outcomes:
            with self.subTest(path.name, spoilings=truth["spoilings"]):
                self.assertEqual((verdict.kind, verdict.reasons), ("right", []))

    def test_what_is_a_little_wrong_is_found(self):
        for path, truth, _ in self.outcomes:
            read = judging.load(self.folder / "read", path.name)
            for wrong in WRONG:
                other = copy.deepcopy(read)
                wrong(truth, other.columns)
                with self.subTest(path.name, wrong=wrong.__name__, spoilings=truth["spoilings"]):
                    self.assertEqual(judging.judge(truth, other).kind, "wrong")


if __name__ == "__main__":
    unittest.main()
