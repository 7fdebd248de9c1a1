"""Runs some scenarios in a process of its own: the task comes in, the content of their file out."""

import sys

import cloudpickle


def main() -> None:
    runner, work, first, end = cloudpickle.load(sys.stdin.buffer)
    sys.stdout.buffer.write(runner(work, first, end))


if __name__ == "__main__":
    main()
