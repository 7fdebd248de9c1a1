"""Executes a notebook in its folder and prints nothing, or the cell that failed.

python tools/run_notebook.py NOTEBOOK
"""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

#: Longest time of a cell, s.
LONGEST = 300


def main() -> None:
    notebook = Path(sys.argv[1])
    read = nbformat.read(notebook, as_version=4)
    where = {"metadata": {"path": str(notebook.parent)}}
    NotebookClient(read, timeout=LONGEST, kernel_name="python3", resources=where).execute()


if __name__ == "__main__":
    main()
