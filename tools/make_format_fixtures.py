"""Makes the small recordings in recording/tests/data/formats: one log, in every format.

    python tools/make_format_fixtures.py [FOLDER]     (tools/requirements.txt)

`log.csv` holds the numbers; every other file holds the same ones as far as its format allows, so
that the tests compare values, not expectations. Only this script writes that folder; workbooks and
MDF files carry the time of their making, so that their bytes differ from call to call.
"""

import datetime
import io
import struct
import sys
import warnings
from pathlib import Path

import asammdf
import h5py
import nptdms
import numpy as np
import odf.opendocument
import odf.table
import odf.text
import openpyxl
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io
import xlwt

FOLDER = Path(__file__).resolve().parent.parent / "recording/tests/data/formats"
SAMPLES = 40
PERIOD = 0.005
T = PERIOD * np.arange(SAMPLES)
# Workbooks keep 15 digits.
U = np.round(6 * np.sin(40 * T) + 0.25, 9)
I = np.round(1.5 * np.cos(40 * T + 0.3), 9)  # noqa: E741
RPM = np.round(900 * np.sin(40 * T - 0.5)).astype(np.int16)
COLUMNS = {"time [s]": T, "u [V]": U, "i [A]": I, "speed [rpm]": RPM}
#: What stands beside the signals in MAT and HDF5 files.
CONSTANTS = {"J": 2.5e-4, "K_m": 0.05}
DAY = datetime.datetime(2024, 3, 1, 8, 30)
#: The same bytes at every call.
STAMP = b"made for tests".ljust(116)


def csv(folder):
    lines = [",".join(COLUMNS)]
    lines += [",".join(repr(x.item()) for x in row) for row in zip(*COLUMNS.values(), strict=True)]
    (folder / "log.csv").write_text("\n".join(lines) + "\n")


def parquet(folder):
    """Types beside doubles, time stamps, a packer that is not read."""
    pq.write_table(pa.table({k: pa.array(v) for k, v in COLUMNS.items()}), folder / "log.parquet")
    few = slice(0, 4)
    stamps = pa.array((1.7e15 + T[few] * 1e6).astype("int64"), pa.timestamp("us"))
    table = {
        "timestamp": stamps,
        "u [V]": pa.array(U[few]),
        "Speed [rpm]": pa.array([30, 60, None, 120], pa.int32()),
        "on": pa.array([True, False, True, True]),
        "i [mA]": pa.array((1000 * I[few]).astype(np.float32)),
        "comment": pa.array(["a", "b", "c", "d"]),
    }
    pq.write_table(pa.table(table), folder / "types.parquet")
    pq.write_table(pa.table({"t": T, "u": U}), folder / "zstd.parquet", compression="zstd")


def mat(folder):
    """MAT 5 plain, packed, with structs and cells; versions that are told apart."""

    def write(name, variables, **options):
        out = io.BytesIO()
        scipy.io.savemat(out, variables, **options)
        data = bytearray(out.getvalue())
        if options.get("format") != "4":
            data[:116] = b"MATLAB 5.0 MAT-file, ".ljust(21) + STAMP[:95]
        (folder / name).write_bytes(bytes(data))

    log = {
        "t": T,
        "Voltage": U.reshape(-1, 1),
        "i": I,
        "speed_rpm": RPM,
        **CONSTANTS,
        "note": "bench 3",
        "late": np.array([1.0, 2.0]),
        "spectrum": U[:4] + 1j,
    }
    write("plain.mat", log, oned_as="column")
    write("packed.mat", log, do_compression=True)
    write("period.mat", {"data": np.column_stack([U, RPM]), "Ts": PERIOD})
    write("struct.mat", {"s": {"time": T, "u": U, "i": I, "speed_rpm": RPM, "motor": CONSTANTS}})
    # What the To Workspace block of Simulink writes as "Structure With Time".
    signals = np.zeros(
        (1, 2), dtype=[("values", object), ("dimensions", object), ("label", object)]
    )
    signals[0, 0] = (U.reshape(-1, 1), 1.0, "u")
    signals[0, 1] = (np.column_stack([I, RPM]), 2.0, "motor")
    out = {"time": T.reshape(-1, 1), "signals": signals, "blockName": "model/To Workspace"}
    write("simulink.mat", {"out": out})
    cell = np.empty((1, 3), dtype=object)
    cell[0, :] = [T, U, "text"]
    write("cell.mat", {"log": cell})
    write("numbers.mat", CONSTANTS)
    write("version4.mat", {"t": T, "u": U}, format="4")


def hdf5(folder):
    """Contiguous, chunked and packed, old and new layouts; MATLAB 7.3."""
    fixed = {"track_times": False}

    def member(group, name, values, unit=None, **options):
        made = group.create_dataset(name, data=values, **fixed, **options)
        if unit:
            made.attrs["unit"] = unit

    packed = {"chunks": (16,), "compression": "gzip", "shuffle": True, "fletcher32": True}
    for name, libver in [("log.h5", "earliest"), ("latest.hdf5", "latest")]:
        with h5py.File(folder / name, "w", libver=libver) as file:
            daq = file.create_group("daq")
            member(daq, "time", T, "s")
            member(daq, "u", U, "V", **packed)
            member(daq, "i", I, np.bytes_("A"), chunks=(7,), maxshape=(None,))
            member(file, "drive/speed", RPM, "rpm", **packed)
            file.attrs["note"] = "bench 3"
            for key, value in CONSTANTS.items():
                member(file, f"motor/{key}", value)
            member(file, "comment", "bench 3")
            member(file, "late", np.array([1.0, 2.0]))
    with h5py.File(folder / "numbers.h5", "w") as file:
        file.attrs.update(CONSTANTS)
    with h5py.File(folder / "table.h5", "w") as file:
        dtype = [("time", "f8"), ("u", "f8"), ("i", "f8"), ("speed_rpm", ">i2")]
        rows = np.array(list(zip(T, U, I, RPM, strict=True)), dtype)
        member(file, "log", rows)
    # MATLAB stores matrices transposed, as 1 x N or N x 1, marks the class, and puts a header
    # of its own in the 512 bytes before.
    with h5py.File(folder / "matlab73.mat", "w", userblock_size=512) as file:

        def matlab(group, name, values, kind="double"):
            made = group.create_dataset(
                name, data=np.atleast_2d(values), **fixed, compression="gzip"
            )
            made.attrs["MATLAB_class"] = np.bytes_(kind)

        s = file.create_group("s")
        s.attrs["MATLAB_class"] = np.bytes_("struct")
        matlab(s, "t", T)
        matlab(s, "u", U.reshape(-1, 1))
        matlab(s, "current", I)
        matlab(file, "speed_rpm", RPM, "int16")
        matlab(file, "both", np.array([U, I]))
        note = file.create_dataset(
            "note", data=np.array([[ord(c)] for c in "bench"], "u2"), **fixed
        )
        note.attrs["MATLAB_class"] = np.bytes_("char")
        note.attrs["MATLAB_int_decode"] = np.int32(2)
        # An array of structs: each field holds references to its values.
        refs = file.create_group("#refs#")
        for name, values in [("b", U), ("c", I)]:
            matlab(refs, name, values)
        for k, name in enumerate(["x_a", "x_b"]):
            letters = np.array([[ord(c)] for c in name], "u2")
            label = refs.create_dataset(f"d{k}", data=letters, **fixed)
            label.attrs["MATLAB_class"] = np.bytes_("char")
        signals = file.create_group("out/signals")
        signals.attrs["MATLAB_class"] = np.bytes_("struct")
        for field, names in [("values", "bc"), ("label", ["d0", "d1"])]:
            array = np.array([[refs[name].ref] for name in names], h5py.ref_dtype)
            signals.create_dataset(field, data=array, **fixed)
        for key, value in CONSTANTS.items():
            matlab(file, key, value)
    path = folder / "matlab73.mat"
    header = b"MATLAB 7.3 MAT-file, ".ljust(21) + STAMP[:95] + bytes(8) + b"\x00\x02IM"
    path.write_bytes(header + path.read_bytes()[128:])


def excel(folder):
    """A page of words first, a title above the header, dates as time stamps."""
    rows = [list(COLUMNS)] + [[x.item() for x in r] for r in zip(*COLUMNS.values(), strict=True)]

    book = openpyxl.Workbook()
    book.active.title = "About"
    book.active.append(["Bench", "3"])
    book.active.append(["Operator", "A. B."])
    sheet = book.create_sheet("Log")
    sheet.append(["Motor test"])
    sheet.append([])
    for row in rows:
        sheet.append([None, *row, None if row is rows[0] else "ok"])
    sheet.cell(3, len(rows[0]) + 2, "state")
    book.save(folder / "log.xlsx")

    book = openpyxl.Workbook()
    book.active.append(["Timestamp", "u [V]", "speed [rpm]", "i"])
    book.active.append(["", "", "", "mA"])
    for k in range(SAMPLES):
        at = DAY + datetime.timedelta(milliseconds=500 * k)
        u = "n/a" if k == 3 else f"{U[k].item()!r}".replace(".", ",") if k == 4 else U[k].item()
        book.active.append([at, u, RPM[k].item(), 1000 * I[k].item()])
    book.save(folder / "dates.xlsx")

    book = odf.opendocument.OpenDocumentSpreadsheet()
    table = odf.table.Table(name="Log")
    for row in [["Timestamp", "u [V]", "speed [rpm]", "i"], ["", "", "", "mA"]]:
        line = odf.table.TableRow()
        for text in row:
            cell = odf.table.TableCell(valuetype="string")
            cell.addElement(odf.text.P(text=text))
            line.addElement(cell)
        table.addElement(line)
    for k in range(SAMPLES):
        at = (DAY + datetime.timedelta(milliseconds=500 * k)).isoformat()
        line = odf.table.TableRow()
        line.addElement(odf.table.TableCell(valuetype="date", datevalue=at))
        words = {3: "n/a", 4: f"{U[4].item()!r}".replace(".", ",")}
        if k in words:
            cell = odf.table.TableCell(valuetype="string")
            cell.addElement(odf.text.P(text=words[k]))
        else:
            cell = odf.table.TableCell(valuetype="float", value=repr(U[k].item()))
        line.addElement(cell)
        for value in (RPM[k].item(), 1000 * I[k].item()):
            line.addElement(odf.table.TableCell(valuetype="float", value=repr(value)))
        table.addElement(line)
    book.spreadsheet.addElement(table)
    book.save(str(folder / "dates.ods"))

    book = xlwt.Workbook()
    sheet = book.add_sheet("Log")
    for r, row in enumerate(rows):
        for c, value in enumerate(row):
            sheet.write(r, c, value)
    book.save(str(folder / "log.xls"))

    book = odf.opendocument.OpenDocumentSpreadsheet()
    table = odf.table.Table(name="Log")
    for row in rows:
        line = odf.table.TableRow()
        for value in row:
            number = not isinstance(value, str)
            about = {"valuetype": "float", "value": repr(value)} if number else {}
            cell = odf.table.TableCell(**(about or {"valuetype": "string"}))
            cell.addElement(odf.text.P(text=str(value)))
            line.addElement(cell)
        table.addElement(line)
    book.spreadsheet.addElement(table)
    book.save(str(folder / "log.ods"))


def tdms(folder):
    """Waveforms and a time channel; one segment, many, interleaved and repeated chunks."""
    start = np.datetime64("2024-03-01T08:30:00")
    wave = {"wf_start_time": start, "wf_start_offset": 0.0, "wf_increment": PERIOD}
    parts = {"u": (U, "V"), "i": (I, "A"), "speed": (RPM, "rpm")}

    def channels(rows, group="bench", **about):
        return [
            nptdms.ChannelObject(group, k, v[rows], {**about, "unit_string": unit})
            for k, (v, unit) in parts.items()
        ]

    root = nptdms.RootObject({"note": "bench 3"})
    group = nptdms.GroupObject("bench", CONSTANTS)
    with nptdms.TdmsWriter(folder / "waveform.tdms") as out:
        out.write_segment([root, group, *channels(slice(None), **wave)])
    with nptdms.TdmsWriter(folder / "segments.tdms") as out:
        for k in range(0, SAMPLES, 10):
            rows = slice(k, k + 10)
            time = nptdms.ChannelObject("bench", "Time", T[rows], {"unit_string": "s"})
            words = nptdms.ChannelObject("bench", "state", ["run"] * 10)
            out.write_segment([time, *channels(rows), words])
    # LabVIEW appends further chunks without repeating what they hold, and may interleave them.
    out = io.BytesIO()
    with nptdms.TdmsWriter(out) as writer:
        writer.write_segment(channels(slice(0, 1), **wave))
    head = bytearray(out.getvalue())
    raw = 28 + int.from_bytes(head[20:28], "little")
    rows = np.zeros(SAMPLES, [("u", "<f8"), ("i", "<f8"), ("speed", "<i2")])
    rows["u"], rows["i"], rows["speed"] = U, I, RPM
    data = rows.tobytes()
    head[12:20] = (raw - 28 + len(data)).to_bytes(8, "little")
    (folder / "chunks.tdms").write_bytes(bytes(head[:raw]) + data)
    toc = int.from_bytes(head[4:8], "little") | 0x20
    head[4:8] = toc.to_bytes(4, "little")
    head = bytes(head).replace(
        (1).to_bytes(4, "little") + (1).to_bytes(8, "little"),
        (1).to_bytes(4, "little") + SAMPLES.to_bytes(8, "little"),
    )
    (folder / "interleaved.tdms").write_bytes(head[:raw] + data)
    counts = np.round(U / 0.001).astype(np.int16)
    scales = {
        "NI_Scaling_Status": "unscaled",
        "NI_Number_Of_Scales": 1,
        "NI_Scale[0]_Scale_Type": "Linear",
        "NI_Scale[0]_Linear_Slope": 0.001,
        "NI_Scale[0]_Linear_Y_Intercept": 0.5,
    }
    with nptdms.TdmsWriter(folder / "scaled.tdms") as out:
        plain = nptdms.ChannelObject("bench", "raw", counts, wave)
        out.write_segment([nptdms.ChannelObject("bench", "u", counts, wave | scales), plain])
    (folder / "big.tdms").write_bytes(big_endian(parts))


def big_endian(parts):
    """nptdms writes no big-endian files, which old controllers do: by hand, with a time."""

    def text(words):
        return struct.pack(">I", len(words)) + words.encode()

    columns = {"time": (T, "s"), **parts}
    meta = struct.pack(">I", len(columns))
    for name, (values, unit) in columns.items():
        code = 2 if values.dtype == np.int16 else 10
        meta += text(f"/'bench'/'{name}'") + struct.pack(">IIIQ", 20, code, 1, SAMPLES)
        meta += struct.pack(">I", 1) + text("unit_string") + struct.pack(">I", 0x20) + text(unit)
    data = b"".join(
        values.astype(values.dtype.newbyteorder(">")).tobytes() for values, _ in columns.values()
    )
    head = b"TDSm" + struct.pack("<I", 0x2 | 0x4 | 0x8 | 0x40)
    return head + struct.pack(">IQQ", 4713, len(meta) + len(data), len(meta)) + meta + data


def mdf(folder):
    """Two groups of different rates, packed, scaled integers, and all groups in one block."""
    warnings.simplefilter("ignore")

    def signal(name, values, unit, time=T, **about):
        return asammdf.Signal(values, time, name=name, unit=unit, **about)

    raw = np.round(U / 0.001).astype(np.int16)
    scale = {"a": 0.001, "b": 0.0}
    slow = signal("temperature", np.array([20.0, 20.5, 21.0]), "degC", np.array([0.0, 0.1, 0.2]))
    fast = [
        signal("u", U, "V"),
        signal("i", I, "A"),
        signal("speed", RPM, "rpm"),
        signal(
            "u_raw", raw, "V", conversion=asammdf.blocks.conversion_utils.from_dict(scale), raw=True
        ),
    ]
    for name, packed in [("log.mf4", 0), ("packed.mf4", 2)]:
        file = asammdf.MDF(version="4.10")
        file.header.start_time = DAY
        file.append([slow], comment="slow")
        file.append(fast, comment="fast")
        file.save(folder / name, overwrite=True, compression=packed)
        file.close()
    (folder / "unsorted.mf4").write_bytes(unsorted((folder / "log.mf4").read_bytes()))


def unsorted(data):
    """The groups of the file in one data group, as a bus logger writes them: every record begins
    with its group's number, and the records lie in many blocks, split anywhere."""
    out = bytearray(data)

    def word(at):
        return int.from_bytes(data[at : at + 8], "little")

    def put(at, value, count=8):
        out[at : at + count] = value.to_bytes(count, "little")

    groups = []
    at = word(64 + 24)
    while at:
        group = word(at + 24 + 8)
        body = group + 24 + 8 * word(group + 16)
        block = word(at + 24 + 16)
        samples, width = word(body + 8), int.from_bytes(data[body + 24 : body + 28], "little")
        rows = data[block + 24 : block + 24 + samples * width]
        records = [rows[k * width : (k + 1) * width] for k in range(samples)]
        groups.append((at, group, body, records))
        at = word(at + 24)
    (first, slow, slow_body, slow_rows), (_, fast, fast_body, fast_rows) = groups
    put(first + 24, 0)
    put(slow + 24, fast)
    put(first + 24 + 8 * word(first + 16), 1, 1)
    put(slow_body, 1)
    put(fast_body, 2)
    stream = b""
    for k, record in enumerate(fast_rows):
        stream += b"\x02" + record
        if k % 13 == 0 and slow_rows:
            stream += b"\x01" + slow_rows.pop(0)
    assert not slow_rows

    def block(mark, links, body):
        out.extend(bytes(-len(out) % 8))
        at = len(out)
        links = b"".join(link.to_bytes(8, "little") for link in links)
        size = 24 + len(links) + len(body)
        out.extend(mark + bytes(4) + struct.pack("<QQ", size, len(links) // 8) + links + body)
        return at

    parts = [block(b"##DT", [], stream[k : k + 101]) for k in range(0, len(stream), 101)]
    offsets = b"".join((101 * k).to_bytes(8, "little") for k in range(len(parts)))
    put(first + 24 + 16, block(b"##DL", [0, *parts], struct.pack("<II", 0, len(parts)) + offsets))
    return bytes(out)


MAKERS = [csv, parquet, mat, hdf5, excel, tdms, mdf]


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    for make in MAKERS:
        make(folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
