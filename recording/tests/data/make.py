"""Makes the binary recordings beside it, as hexadecimal text: scipy 1.17.1, pyarrow 26.0.1.

    python make.py     (needs numpy, scipy, pyarrow)

Every file holds the same four samples, t = 0, 0.5, 1, 1.5 s, u = 1.5, -2, 2.5, 3 V,
speed 30, 60, -90, 120 rpm, as far as its format's point allows.
"""

import io
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io

HERE = Path(__file__).parent
T = np.array([0.0, 0.5, 1.0, 1.5])
U = np.array([1.5, -2.0, 2.5, 3.0])
RPM = np.array([30, 60, -90, 120], dtype=np.int16)


def keep(name, data):
    text = data.hex()
    lines = [text[k : k + 100] for k in range(0, len(text), 100)]
    (HERE / f"{name}.hex").write_text("\n".join(lines) + "\n")


def mat(name, variables, **options):
    out = io.BytesIO()
    scipy.io.savemat(out, variables, **options)
    data = bytearray(out.getvalue())
    if options.get("format") != "4":
        # The header's text carries the date: the same bytes at every call.
        data[:116] = b"MATLAB 5.0 MAT-file, scipy".ljust(116)
    keep(name, bytes(data))


def parquet(name, columns, **options):
    out = io.BytesIO()
    pq.write_table(pa.table(columns), out, **options)
    keep(name, out.getvalue())


log = {
    "t": T,
    "Voltage": U.reshape(-1, 1),
    "speed_rpm": RPM,
    "gtau": 35.15,
    "note": "bench 3",
    "setup": {"R": 3.1},
    "late": np.array([1.0, 2.0]),
    "spectrum": U + 1j,
}
mat("mat_plain", log, oned_as="column")
mat("mat_packed", log, do_compression=True)
mat("mat_sampling_time", {"data": np.column_stack([U, RPM]), "Ts": 0.5})
mat("mat_struct", {"log": {"t": T, "u": U}})
mat("mat_version_4", {"t": T, "u": U}, format="4")

stamps = pa.array((1_700_000_000_000_000 + T * 1e6).astype("int64"), pa.timestamp("us"))
table = {
    "timestamp": stamps,
    "u [V]": pa.array(U),
    "Speed [rpm]": pa.array([30, 60, None, 120], pa.int32()),
    "on": pa.array([True, False, True, True]),
    "i [mA]": pa.array(U.astype(np.float32)),
    "comment": pa.array(["a", "b", "c", "d"]),
}
parquet("parquet_pyarrow", table)
parquet("parquet_zstd", {"t": T, "u": U}, compression="zstd")
