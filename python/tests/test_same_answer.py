"""The functions answer what the command line answers, byte for byte."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd

import drivescope as ds
from support import INPUTS, InFolder

BOTH = ["1.csv", "2.csv"]


class SameAnswer(InFolder):
    def test_simulate(self) -> None:
        options = ("--input", INPUTS[0], "--duration", "1", "--fault", "tacho=5%@0.5")
        told = self.told("simulate", "machine.toml", "-o", "run.csv", "--seed", "7", *options)
        command = Path("run.csv").read_bytes()
        answer = ds.simulate(
            "machine.toml",
            output="run.csv",
            input=INPUTS[0],
            duration=1.0,
            fault="tacho=5%@0.5",
            seed=7,
        )
        self.assertEqual(answer.json, told)
        self.assertEqual(Path("run.csv").read_bytes(), command)

    def test_simulate_replays_what_was_measured(self) -> None:
        told = self.told("simulate", "model.toml", "--measured", "1.csv", "-o", "run.csv")
        measured = ds.Recording.read("1.csv")
        for given in ("1.csv", measured, ds.Recording(measured.to_pandas(), name="1.csv")):
            answer = ds.simulate("model.toml", measured=given, output="run.csv")
            self.assertEqual(answer.json, told)

    def test_compare_from_files_frames_tables_and_runs(self) -> None:
        told = self.told("compare", "model.toml", *BOTH, "--seed", "3")
        frames = [ds.Recording(pd.read_csv(it), name=it) for it in BOTH]
        tables = [ds.Recording(it.to_arrow(), name=it.name) for it in frames]
        ways = {
            "files": BOTH,
            "read": [ds.Recording.read(it) for it in BOTH],
            "frames": frames,
            "tables": tables,
        }
        for way, recordings in ways.items():
            with self.subTest(way):
                drive = ds.Drive("model.toml") if way == "frames" else "model.toml"
                self.assertEqual(ds.compare(drive, recordings, seed=3).json, told)

    def test_compare_of_a_run_in_memory(self) -> None:
        run = ds.simulate("machine.toml", input=INPUTS[1], duration=4.0, seed=9)
        self.assertNotIn("output", run)
        run.recording.write("memory.csv")
        told = json.loads(self.told("compare", "model.toml", "memory.csv"))
        answer = dict(ds.compare("model.toml", run.recording))
        # But for its name it is the file.
        for it in (*told["recordings"], *answer["recordings"], *told["spans"], *answer["spans"]):
            it.pop("name", None)
            it.pop("recording", None)
        self.assertEqual(answer, told)

    def test_fit(self) -> None:
        told = self.told("fit", "model.toml", *BOTH, "-o", "fitted.toml", "--noise", "i=0.005")
        text = Path("fitted.toml").read_text()
        answer = ds.fit("model.toml", BOTH, output="fitted.toml", noise={"i": 0.005})
        self.assertEqual(answer.json, told)
        self.assertEqual(answer.drive.text, text)
        in_memory = ds.fit(ds.Drive("model.toml"), BOTH, noise={"i": 0.005})
        told = json.loads(told)
        del told["output"]
        self.assertEqual(dict(in_memory), told)
        self.assertEqual(in_memory.drive.text, text)

    def test_discover(self) -> None:
        told = self.told("discover", "model.toml", *BOTH, "-o", "found.toml", "--out", "a.html")
        answer = ds.discover("model.toml", BOTH, output="found.toml", out="b.html")
        self.assertEqual(answer.json, told)
        self.assertEqual(answer["named"], ["cogging"])
        self.assertEqual(answer.report, Path("a.html").read_text())
        self.assertEqual(Path("b.html").read_text(), answer.report)
        assert answer.drive is not None
        self.assertIn("cogging", answer.drive.text)

    def test_train_and_diagnose(self) -> None:
        runs = {"healthy": (), "again": (), "faulty": ("tacho=20%@4",)}
        for seed, (name, faults) in enumerate(runs.items(), 1):
            run = ds.simulate("dr300", duration=10.0, seed=seed, fault=faults)
            run.recording.write(f"{name}.csv")
        few = ("--without", "recurrent,gmdh")
        told = self.told("train", "healthy.csv", "again.csv", "-o", "known.toml", *few)
        known = Path("known.toml").read_text()
        healthy = [ds.Recording.read("healthy.csv"), "again.csv"]
        without = ("recurrent", "gmdh")
        answer = ds.train(healthy, without=without, output="known.toml")
        self.assertEqual(answer.json, told)
        self.assertEqual(answer.diagnoser.text, known)
        told = self.told("diagnose", "known.toml", "faulty.csv")
        found = ds.diagnose("known.toml", ds.Recording.read("faulty.csv"))
        self.assertEqual(found.json, told)
        self.assertEqual(found["verdict"], "fault")
        told = json.loads(told)
        del told["diagnoser"]
        self.assertEqual(dict(ds.diagnose(answer.diagnoser, "faulty.csv")), told)
        self.assertIn("iframe", found._repr_html_())

    def test_export(self) -> None:
        told = self.told("export", "machine.toml", "-o", "machine.fmu", "--open-loop")
        bytes_ = Path("machine.fmu").read_bytes()
        answer = ds.export_fmu("machine.toml", "machine.fmu", open_loop=True)
        self.assertEqual(answer.json, told)
        self.assertEqual(Path("machine.fmu").read_bytes(), bytes_)
