"""Runs the shipped plan and reads what it wrote with pandas, Polars and DuckDB.

    python tools/check_campaign.py DRIVESCOPE

Rows, types, units and missing values must be the same in all three. Exit status 1 if something is
wrong.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import duckdb
import pandas
import polars
import pyarrow.parquet

PLAN = Path(__file__).resolve().parent.parent / "scenarios/plans/quick.toml"
SCENARIOS = 240
SECONDS = 600
UNITS = {"fault_onset": "s", "set_point": "rad/s", "R": "ohm", "bands_delay": "s"}


def run(program, *arguments):
    """Runs drivescope; its standard output."""
    command = [program, *map(str, arguments), "--quiet"]
    return subprocess.run(
        command, capture_output=True, text=True, check=True, timeout=SECONDS
    ).stdout


def same(name, a, b):
    """Whether two columns hold the same values, missing ones among them."""
    if len(a) != len(b) or any(
        (x is None) != (y is None) or (x is not None and x != y) for x, y in zip(a, b, strict=True)
    ):
        raise SystemExit(f"{name}: not the same in all readers")


def main():
    """Checks a dataset that it makes."""
    program = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "quick"
        run(program, "campaign", PLAN, "-o", out)
        dataset = out / "campaign.parquet"
        assert [path.name for path in out.glob("**/*.parquet")] == [dataset.name]

        frame = pandas.read_parquet(dataset)
        assert len(frame) == SCENARIOS and list(frame["scenario"]) == list(range(SCENARIOS))
        assert set(frame["status"]) == {"done"}
        faulty = frame["fault_kind"] != "none"
        assert frame["bands_detected"].notna().equals(faulty)
        assert frame.loc[frame["bands_detected"] == True, "bands_delay"].notna().all()  # noqa: E712
        assert not frame["scenario"].duplicated().any()

        table = pyarrow.parquet.read_table(dataset)
        for name, unit in UNITS.items():
            said = table.schema.field(name).metadata
            assert said[b"unit"].decode() == unit and said[b"description"], name
        said = pyarrow.parquet.read_metadata(dataset).metadata
        assert b"draws = 10" in said[b"drivescope.plan"] and said[b"drivescope.version"]

        lazy = polars.scan_parquet(out / "*.parquet").sort("scenario").collect()
        asked = duckdb.sql(f"select * from '{out}/*.parquet' order by scenario").fetchnumpy()
        rows = duckdb.sql(f"select * from '{out}/*.parquet' order by scenario").fetchall()
        for k, name in enumerate(table.column_names):
            arrow = table.column(name).to_pylist()
            same(name, arrow, lazy[name].to_list())
            same(name, arrow, [row[k] for row in rows])
        assert list(asked) == table.column_names
        found = duckdb.sql(
            f"select fault_kind, avg(bands_detected::int) from '{dataset}' "
            "where abs(fault_size) > 0.1 group by fault_kind order by fault_kind"
        ).fetchall()
        assert [kind for kind, _ in found] == ["actuator", "flux", "load", "tacho"]

        summary = json.loads(run(program, "campaign", "report", out, "--json", "-"))
        share = {method["method"]: method["detected"] for method in summary["methods"]}
        for method in ("constant", "bands", "cusum"):
            assert share[method]["of"] == int(faulty.sum())
            assert share[method]["hits"] == int((frame[f"{method}_detected"] == True).sum())  # noqa: E712
    print(
        f"{SCENARIOS} scenarios, {len(table.column_names)} columns: pandas, Polars and DuckDB agree"
    )


if __name__ == "__main__":
    main()
