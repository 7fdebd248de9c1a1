"""The command line: `python -m drivescope COMMAND`, or `drivescope COMMAND`."""

import sys

from . import _drivescope


def main() -> int:
    """Run the command line; the exit code."""
    return _drivescope.main(["drivescope", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
