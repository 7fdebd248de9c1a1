"""The converter against the fixtures of the formats: the values of the log, whatever it is in."""

import tempfile
import unittest
from pathlib import Path

import numpy as np
from convert_recording import NotConverted, convert

FIXTURES = Path(__file__).resolve().parent.parent / "recording/tests/data/formats"


def columns(path):
    lines = path.read_text().splitlines()
    rows = np.array([[float(x) for x in line.split(",")] for line in lines[1:]])
    return {name.split(" [")[0]: rows[:, k] for k, name in enumerate(lines[0].split(","))}


class Converted(unittest.TestCase):
    """Every format, and the varieties that the program itself sends here."""

    def converted(self, name, suffix=".csv"):
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / f"out{suffix}"
            convert(FIXTURES / name, out)
            if suffix == ".csv":
                return columns(out)
            again = Path(folder) / "again.csv"
            convert(out, again)
            return columns(again)

    def test_the_values_of_the_log(self):
        log = columns(FIXTURES / "log.csv")
        # Not log.xlsx: a title above the names needs an eye.
        names = ["log.parquet", "zstd.parquet", "log.xls", "log.ods"]
        names += ["version4.mat", "plain.mat", "struct.mat", "matlab73.mat", "log.h5", "table.h5"]
        names += ["waveform.tdms", "segments.tdms", "interleaved.tdms", "log.mf4", "packed.mf4"]
        for name in names:
            for suffix in (".csv", ".parquet"):
                with self.subTest(name, suffix=suffix):
                    read = self.converted(name, suffix)
                    signals = {k.lower(): v for k, v in read.items()}
                    u = signals.get("u", signals.get("voltage"))
                    self.assertTrue(np.array_equal(u, log["u"]))
                    time = next(iter(read.values()))
                    self.assertTrue(np.allclose(time, log["time"], rtol=0, atol=1e-12))

    def test_what_cannot_be_converted_is_said(self):
        for name in ("numbers.mat", "numbers.h5"):
            with self.subTest(name), self.assertRaises(NotConverted):
                self.converted(name)
        with self.assertRaises(NotConverted):
            convert(FIXTURES / "log.csv", Path("out.mat"))


if __name__ == "__main__":
    unittest.main()
