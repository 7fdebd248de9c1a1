"""Drives a campaign, as a process that can be killed: `drive_campaign.py ADDRESS`."""

import sys

import cluster
from distributed import Client

from drivescope import dask

with Client(sys.argv[1], timeout=cluster.PATIENCE) as client:
    client.wait_for_workers(cluster.WORKERS, timeout=cluster.PATIENCE)
    dask.campaign("plan.toml", "spread", client, batch_s=0.1, runner=cluster.slowly)
