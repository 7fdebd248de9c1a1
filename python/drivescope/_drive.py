"""Drives and diagnosers: files that people read, held as text."""

from __future__ import annotations

import html
import os
import tempfile
from pathlib import Path

from . import _drivescope


def write_whole(path: str | os.PathLike[str], text: str) -> None:
    """Write a file, whole or not at all."""
    path = Path(path)
    handle, temporary = tempfile.mkstemp(prefix=".drivescope-", dir=path.parent)
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="") as out:
            out.write(text)
        # Readable as any new file is, not by the owner alone.
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(temporary, 0o666 & ~umask)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


class _Text:
    """A text with a name for messages."""

    #: The text of the file.
    text: str
    #: What messages call it: the path or the name that it came from.
    source: str

    def __init__(self, text: str, source: str) -> None:
        self.text = text
        self.source = source

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write it to a file, whole or not at all."""
        write_whole(path, self.text)

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and other.text == self.text  # type: ignore[attr-defined]

    def __hash__(self) -> int:
        return hash(self.text)

    def _repr_html_(self) -> str:
        name, text = html.escape(repr(self)), html.escape(self.text)
        return f"<details><summary>{name}</summary><pre>{text}</pre></details>"


class Drive(_Text):
    """A drive: a drive file, or a built-in one (`dr300`, `emps`).

    Raises `drivescope.Error` with line and column where the file is wrong.
    """

    #: What the file calls the drive.
    name: str

    def __init__(self, source: str | os.PathLike[str]) -> None:
        text, self.name = _drivescope.drive(os.fspath(source))
        super().__init__(text, os.fspath(source))

    @classmethod
    def parse(cls, text: str, source: str = "drive.toml") -> Drive:
        """Make a drive of the text of a drive file; `source` is what messages call it."""
        made = cls.__new__(cls)
        made.name = _drivescope.drive_name(text, source)
        _Text.__init__(made, text, source)
        return made

    def __repr__(self) -> str:
        return f"Drive({self.name!r}, {self.source!r})"


class Diagnoser(_Text):
    """A diagnoser file, as `train` makes it."""

    def __init__(self, source: str | os.PathLike[str]) -> None:
        try:
            text = Path(source).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise _drivescope.Error(f"{os.fspath(source)}: cannot be read: {error}") from error
        super().__init__(text, os.fspath(source))

    @classmethod
    def parse(cls, text: str, source: str = "diagnoser.toml") -> Diagnoser:
        """Make a diagnoser of the text of a diagnoser file."""
        made = cls.__new__(cls)
        _Text.__init__(made, text, source)
        return made

    def __repr__(self) -> str:
        return f"Diagnoser({self.source!r})"
