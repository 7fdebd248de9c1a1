"""Text files as loggers, spreadsheets and people write them."""

import datetime
import re
from dataclasses import dataclass, field

import numpy as np

from .naming import Column

DAY = datetime.datetime(2024, 5, 3, 14, 20, 7, 250000, tzinfo=datetime.UTC)
EPOCH = DAY.timestamp()
BEFORE_MIDNIGHT_S = 86_400.0 - 0.7

PREAMBLES = {
    "title": ["Messung 7: Prüfstand 3"],
    "settings": ["Date: 2024-05-03 14:20", "Operator: N. N.", "Samples: 3000", ""],
    "table": ["Gerät{0}A7", "Kanäle{0}3", "Start{0}14:20:07", ""],
    "rate": ["Sampling rate: {1:.6g} Hz", "Firmware 2.1"],
    "equals": ["version=2.10", "gain=1.5"],
}
FOOTERS = ["Ende der Messung", "# end", "End of file", "Total samples: 3000", "\n"]
COMMENTS = ["# marker", "# Änderung der Last", "# 12:30 door opened, then closed"]


@dataclass
class Layout:
    """What is done to the text of a file."""

    rng: np.random.Generator
    encoding: str = "utf-8"
    bom: bytes = b""
    delimiter: str = ","
    comma: bool = False
    declared: bool = False
    preamble: str = None
    footer: str = None
    comments: bool = False
    headers: list = field(default_factory=list)
    """Rows before which the header stands again."""
    trailing: bool = False
    quoted: str = None
    thousands: str = None
    line_end: str = "\n"
    missing: str = None
    unit_row: bool = False

    def bytes(self, columns, naming, period):
        """The file."""
        blank = self.delimiter == " "
        names = [naming.header(column, joined=blank) for column in columns]
        head = [self.line(names, header=True)]
        if self.unit_row:
            brackets = self.rng.random() < 0.5
            units = [column.unit or ("-" if blank else "") for column in columns]
            units = [unit.replace(" ", "") if blank else unit for unit in units]
            head.append(self.line([f"[{unit}]" if brackets else unit for unit in units], True))
        above = [f"sep={self.delimiter}"] if self.declared else []
        above += [it.format(self.delimiter, 1 / period) for it in PREAMBLES.get(self.preamble, [])]
        if naming.counts == "counts":
            above.append("Counts per revolution: 4096")
        cells = [self.numbers(column) if column.number else column.cells for column in columns]
        rows = [self.line(row) for row in zip(*cells, strict=True)]
        if blank:
            rows = [self.aligned(row) for row in rows]
        for at in reversed(self.headers):
            rows[at:at] = head
        if self.comments:
            for _ in range(3):
                at = int(self.rng.integers(1, len(rows)))
                rows.insert(at, str(self.rng.choice(COMMENTS)))
        below = [self.footer] if self.footer else []
        text = "\n".join(above + head + rows + below) + "\n"
        return self.bom + text.replace("\n", self.line_end).encode(self.encoding)

    def line(self, cells, header=False):
        if self.quoted == "all" or self.quoted == "names" and header:
            cells = [f'"{cell}"' for cell in cells]
        return self.delimiter.join(cells) + (self.delimiter if self.trailing else "")

    def aligned(self, row):
        return " " + re.sub(" ", "   ", row)

    def numbers(self, column):
        """Cells of numbers as they are written here."""
        cells = column.cells
        if self.thousands is not None:
            cells = [_grouped(cell) for cell in cells]
        if self.thousands is not None or self.comma:
            marks = str.maketrans({",": self.thousands or "", ".": "," if self.comma else "."})
            cells = [cell.translate(marks) for cell in cells]
        return cells


def _grouped(cell):
    """1234.5 as 1,234.5."""
    if not cell.lstrip("-").replace(".", "").isdigit():
        return cell
    whole, dot, rest = cell.partition(".")
    return f"{int(whole):,}{dot}{rest}" if abs(int(whole)) >= 1000 else cell


def number_clock(stamps, name, unit, factor, decimals, offset=0.0):
    """A column of seconds times `factor` after `offset` s; the step of its digits, s."""
    if offset == 0.0:
        cells = np.char.mod(f"%.{decimals}f", stamps * factor).tolist()
    else:
        # Digits of an epoch do not fit a double: whole units are added as integers.
        ticks = np.round(stamps * factor * 10**decimals).astype(np.int64)
        ticks += round(offset * factor) * 10**decimals
        whole, rest = np.divmod(ticks, 10**decimals)
        cells = np.char.mod("%d", whole)
        if decimals:
            cells = np.char.add(cells, np.char.mod(f".%0{decimals}d", rest))
        cells = cells.tolist()
    return Column(name, unit, cells), 1.0 / (factor * 10.0**decimals)


def iso_clock(stamps, name, decimals, mark, zone):
    """Dates and times."""
    ticks = np.round(stamps * 10**decimals).astype(np.int64)
    scaled = DAY.replace(tzinfo=None)
    start = np.datetime64(scaled, "us")
    moments = start + (ticks * 10 ** (6 - decimals)).astype("timedelta64[us]")
    cells = np.datetime_as_string(moments, unit="us").tolist()
    cells = [cell[: 20 + decimals].replace("T", mark) + zone for cell in cells]
    return Column(name, "", cells, number=False), 10.0**-decimals


def day_clock(stamps, name, decimals, start=BEFORE_MIDNIGHT_S):
    """Times of day, over midnight."""
    ticks = np.round((start + stamps) * 10**decimals).astype(np.int64)
    ticks %= 86_400 * 10**decimals
    whole, rest = np.divmod(ticks, 10**decimals)
    hours, minutes, seconds = whole // 3600, whole // 60 % 60, whole % 60
    cells = [
        f"{h:02d}:{m:02d}:{s:02d}.{r:0{decimals}d}"
        for h, m, s, r in zip(hours, minutes, seconds, rest, strict=True)
    ]
    return Column(name, "", cells, number=False), 10.0**-decimals
