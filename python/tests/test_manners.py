"""Arrays, errors, Ctrl-C, progress, threads."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pandas as pd

import drivescope as ds
from drivescope import _drivescope
from support import INPUTS, InFolder

#: Seconds of a run that nothing here waits for.
LONG = 5e3


class Signals(InFolder):
    def test_arrays_come_without_a_copy_and_are_not_written_to(self) -> None:
        run = ds.simulate("machine.toml", input=INPUTS[0], duration=1.0).recording
        omega = run["omega"]
        self.assertIs(omega, run["omega"])
        self.assertEqual(omega.dtype, np.float64)
        with self.assertRaises(ValueError):
            omega[0] = 1.0
        table = run.to_arrow()
        column = table.column("omega [rad/s]").chunk(0)
        self.assertEqual(column.buffers()[1].address, omega.ctypes.data)
        self.assertEqual(run.units["omega"], "rad/s")
        self.assertEqual(len(run), len(run.time))
        with self.assertRaisesRegex(KeyError, "there are u, i, omega"):
            run["speed"]

    def test_a_recording_goes_through_a_frame_unchanged(self) -> None:
        before = ds.Recording.read("1.csv")
        after = ds.Recording(before.to_pandas(), name="1.csv")
        self.assertEqual(before.units, after.units)
        for name in before:
            np.testing.assert_array_equal(before[name], after[name])
        np.testing.assert_array_equal(before.time, after.time)

    def test_frames_of_other_makes(self) -> None:
        time_s = np.arange(500) * 0.01
        speed = 60.0 * np.sin(time_s)
        instants = pd.to_datetime("2026-01-01") + pd.to_timedelta(time_s, unit="s")
        frame = pd.DataFrame({"Speed [rpm]": speed, "note": "a", "u [V]": 1.0}, index=instants)
        recording = ds.Recording(frame)
        np.testing.assert_allclose(recording["omega"], speed * np.pi / 30, rtol=1e-12)
        self.assertAlmostEqual(recording.period, 0.01)
        self.assertTrue(any("`note`" in it for it in recording.remarks), recording.remarks)
        nullable = pd.DataFrame({"time [s]": time_s, "omega [rad/s]": speed}).convert_dtypes()
        nullable.loc[7, "omega [rad/s]"] = pd.NA
        self.assertTrue(any("missing" in it for it in ds.Recording(nullable).remarks))
        mapping = {"omega [rad/s]": list(speed), "u": np.ones(500, dtype=np.float32)}
        self.assertEqual(ds.Recording(mapping, rows_every=0.01).period, 0.01)
        two = ds.Recording({"time": [0, 1, 2, 50, 51, 52], "omega [rad/s]": np.arange(6.0)})
        self.assertEqual([len(range(6)[it]) for it in two.segments], [3, 3])
        self.assertIn("segment [1]", two.to_pandas())
        named = {"Drehzahl": "omega", "U": "u"}
        foreign = {"t": time_s, "Drehzahl": speed, "U": speed}
        columns = {signal: column for column, signal in named.items()}
        self.assertEqual(set(ds.Recording(foreign, columns=columns)), {"omega", "u"})

    def test_notebooks_show_results(self) -> None:
        recording = ds.Recording.read("1.csv")
        answer = ds.compare("model.toml", [recording])
        for shown in (recording, answer, ds.fit("model.toml", recording), ds.Drive("emps")):
            self.assertRegex(shown._repr_html_(), "(?s)^<(iframe|table|details).*>$")
        self.assertIn("<svg", answer.report)
        self.assertIn("error", str(answer))


class Refusals(InFolder):
    def test_the_words_are_those_of_the_command_line(self) -> None:
        Path("wrong.toml").write_text("schema = 1\n[motor]\nR = -1\n")
        cases = [
            (lambda: ds.Drive("wrong.toml"), ("compare", "wrong.toml", "1.csv")),
            (lambda: ds.compare("model.toml", "none.csv"), ("compare", "model.toml", "none.csv")),
            (lambda: ds.simulate("dr3000"), ("simulate", "dr3000", "-o", "a.csv")),
            (
                lambda: ds.fit("model.toml", "1.csv", noise={"v": 1.0}),
                ("fit", "model.toml", "1.csv", "-o", "a.toml", "--noise", "v=1"),
            ),
            (
                lambda: ds.simulate("dr300", duration=-1.0),
                ("simulate", "dr300", "-o", "a.csv", "--duration", "-1"),
            ),
        ]
        for refused, command in cases:
            with self.assertRaises(ds.Error) as raised:
                refused()
            told = self.told(*command, code=2)
            for line in str(raised.exception).splitlines():
                self.assertIn(line.strip(), told)
        self.assertFalse(Path("a.csv").exists())

    def test_what_python_can_get_wrong_is_an_error_too(self) -> None:
        wrong = [
            lambda: ds.Recording({}),
            lambda: ds.Recording({"time": [0.0, 1.0], "omega": [1.0]}),
            lambda: ds.Recording({"omega [rad/s]": [1.0, 2.0]}),
            lambda: ds.Recording({"time": [], "omega": []}),
            lambda: ds.compare("model.toml", []),
            lambda: ds.compare("model.toml", "-"),
            lambda: ds.study(torque="sideways"),  # type: ignore[arg-type]
            lambda: ds.export_fmu("dr300", "no/such/folder/a.fmu"),
            lambda: ds.diagnose("none.toml", "1.csv"),
            lambda: ds.Drive.parse("schema = 2"),
        ]
        for number, refused in enumerate(wrong):
            with self.subTest(number), self.assertRaises(ds.Error):
                refused()
        self.assertTrue(issubclass(ds.Error, ValueError))

    def test_one_name_may_be_two_recordings(self) -> None:
        both = [ds.Recording(ds.Recording.read(it).to_pandas()) for it in ("1.csv", "2.csv")]
        names = [it["name"] for it in ds.compare("model.toml", both)["recordings"]]
        self.assertEqual(names, ["recording", "recording (2)"])


class WhileItRuns(InFolder):
    def test_other_threads_go_on(self) -> None:
        counted = 0
        ended = threading.Event()

        def count() -> None:
            nonlocal counted
            while not ended.is_set():
                counted += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        began = time.monotonic()
        ds.simulate("machine.toml", input="1", duration=400.0, noise=False)
        took = time.monotonic() - began
        ended.set()
        thread.join()
        # A lock that was held would let it count some times only.
        self.assertGreater(counted, 100 * took)

    def test_progress_is_told_and_may_end_the_call(self) -> None:
        told: list[tuple[str, int, int | None]] = []

        def progress(doing: str, done: int, of: int | None) -> None:
            told.append((doing, done, of))
            if done > 0:
                raise StopIteration(doing)

        began = time.monotonic()
        with self.assertRaises(StopIteration):
            ds.simulate("machine.toml", input="1", duration=LONG, progress=progress)
        self.assertLess(time.monotonic() - began, 20.0)
        self.assertEqual(told[-1][0], "simulating")
        self.assertEqual(told[-1][2], LONG / 1e-3 + 1)

    def test_ctrl_c_ends_a_call_and_leaves_nothing(self) -> None:
        script = (
            "import signal\n"
            "import drivescope as ds\n"
            # Who starts tests in the background may have had it ignored.
            "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
            "try:\n"
            f"    ds.simulate('machine.toml', input='1', duration={LONG}, output='never.csv',\n"
            "                progress=lambda *_: print('runs', flush=True))\n"
            "except KeyboardInterrupt:\n"
            "    print('stopped', flush=True)\n"
            "print(len(ds.simulate('dr300').recording))\n"
        )
        process = subprocess.Popen(
            [sys.executable, "-c", script], stdout=subprocess.PIPE, text=True
        )
        assert process.stdout is not None
        self.assertEqual(process.stdout.readline(), "runs\n")
        process.send_signal(signal.SIGINT)
        rest = process.communicate(timeout=60)[0].splitlines()
        self.assertEqual(process.returncode, 0)
        self.assertEqual([it for it in rest if it != "runs"], ["stopped", "1001"])
        self.assertFalse(Path("never.csv").exists())
        self.assertEqual([it for it in os.listdir() if it.startswith(".drivescope")], [])

    def test_calls_run_side_by_side(self) -> None:
        answers: dict[int, str] = {}

        def run(seed: int) -> None:
            answers[seed] = ds.compare("model.toml", ["1.csv", "2.csv"], seed=seed).json

        threads = [threading.Thread(target=run, args=(seed,)) for seed in (1, 2, 1 + 2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for seed, told in answers.items():
            self.assertEqual(ds.compare("model.toml", ["1.csv", "2.csv"], seed=seed).json, told)
        self.assertEqual(len(answers), 3)

    def test_the_version_is_the_programs(self) -> None:
        from support import PROGRAM

        told = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout
        self.assertEqual(told.split(), ["drivescope", ds.__version__])
        self.assertIs(ds.Error, _drivescope.Error)
