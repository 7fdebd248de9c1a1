"""Campaigns on a cluster: nothing is lost and nothing twice, whatever is killed."""

from __future__ import annotations

import hashlib
import os
import signal
import subprocess
import sys
from pathlib import Path
from unittest import mock

import cluster
from cluster import PATIENCE, PLAN, POISON, WORKERS, Cluster, until
from distributed import Client

import drivescope as ds
from drivescope import _drivescope, dask
from support import InFolder

DRIVER = Path(__file__).with_name("drive_campaign.py")


def digest(dataset: Path) -> str:
    return hashlib.sha256(dataset.read_bytes()).hexdigest()


def parts() -> set[Path]:
    return set(Path("spread").glob("part-*.parquet"))


class Spread(InFolder):
    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        Path("plan.toml").write_text(PLAN)
        Path("bench.toml").write_text(ds.Drive("dr300").text)

    def cluster(self) -> Cluster:
        made = Cluster()
        self.addCleanup(made.end)
        return made

    def client(self, made: Cluster) -> Client:
        client = Client(made.address, timeout=PATIENCE)
        self.addCleanup(client.close)
        client.wait_for_workers(WORKERS, timeout=PATIENCE)
        return client

    def test_what_is_killed_is_made_up_for(self) -> None:
        serial = ds.campaign("plan.toml", "serial")
        scenarios = serial["scenarios"]
        # The same with the row of the one that ends its process.
        reference = _drivescope.Scenarios.in_folder("plan.toml", "reference")
        for first, end in ((0, POISON), (POISON + 1, scenarios)):
            reference.run(first, end, Path("reference") / _drivescope.part(first, end))
        poison = Path("reference") / _drivescope.part(POISON, POISON + 1)
        reference.aborted(POISON, poison)
        reference.release()
        expected = digest(Path(_drivescope.merged("reference")))
        self.assertNotEqual(digest(Path("serial/campaign.parquet")), expected)

        first = self.cluster()
        log = Path("driver.log").open("w")
        driver = subprocess.Popen([sys.executable, DRIVER, first.address], stderr=log)
        self.addCleanup(log.close)
        self.addCleanup(driver.wait)
        self.addCleanup(driver.kill)
        client = self.client(first)
        until(lambda: len(parts()) >= 2, "no batch arrives")
        # A worker, in the middle of a batch; its nanny starts another.
        os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)
        there = len(parts())
        until(lambda: len(parts()) > there, "nothing arrives after the loss of a worker")
        client.close()
        # The scheduler and the driver.
        driver.kill()
        first.end()
        driver.wait(PATIENCE)
        left = {it: it.stat().st_mtime_ns for it in parts()}
        self.assertFalse(Path("spread/campaign.parquet").exists())

        again = self.client(self.cluster())
        told: list[int] = []
        with self.assertRaisesRegex(ds.Error, "scenarios are there already"):
            dask.campaign("plan.toml", "spread", again)
        done = dask.campaign(
            "plan.toml",
            "spread",
            again,
            resume=True,
            batch_s=0.3,
            runner=cluster.slowly,
            progress=lambda _, count, of: told.append(count),
        )
        self.assertGreater(told[0], len(left))
        self.assertEqual((done.scenarios, done.aborted), (scenarios, (POISON,)))
        self.assertEqual(digest(done.dataset), expected)
        numbers = done.to_pandas()["scenario"].tolist()
        self.assertEqual(numbers, list(range(scenarios)))
        self.assertEqual(parts(), set())

    def test_a_cluster_gives_the_bytes_of_one_machine(self) -> None:
        client = self.client(self.cluster())
        serial = ds.campaign("plan.toml", "alone")
        self.assertEqual(serial["aborted"], [])
        done = dask.campaign("plan.toml", "together", client)
        self.assertEqual(digest(done.dataset), digest(Path("alone/campaign.parquet")))
        # Another version on the workers.
        with (
            mock.patch.object(_drivescope, "__version__", "9.9"),
            self.assertRaisesRegex(ds.Error, r"has drivescope \d.*, the campaign is driven by 9.9"),
        ):
            dask.campaign("plan.toml", "other", client)
        # The FMU beside the plan is sent along.
        ds.export_fmu("bench.toml", "machine.fmu")
        words = PLAN.replace("seed = 5", 'seed = 5\nfmu = "machine.fmu"\nkeep_traces = 0.1')
        Path("fmu.toml").write_text(words.replace("draws = 120", "draws = 6"))
        ds.campaign("fmu.toml", "fmu-alone")
        done = dask.campaign("fmu.toml", "fmu-together", client, batch_s=0.2)
        self.assertEqual(digest(done.dataset), digest(Path("fmu-alone/campaign.parquet")))
        kept = {it.name: it.read_bytes() for it in Path("fmu-alone/traces").iterdir()}
        self.assertTrue(kept)
        sent = {it.name: it.read_bytes() for it in Path("fmu-together/traces").iterdir()}
        self.assertEqual(sent, kept)
        # A folder of another run, of another plan, and with the scheduler gone.
        held = _drivescope.Scenarios.in_folder("plan.toml", "held")
        with self.assertRaisesRegex(ds.Error, "another run writes there"):
            dask.campaign("plan.toml", "held", client)
        held.release()
        Path("other.toml").write_text(PLAN.replace("seed = 5", "seed = 6"))
        with self.assertRaisesRegex(ds.Error, "of another plan"):
            dask.campaign("other.toml", "held", client)


if __name__ == "__main__":
    import unittest

    unittest.main()
