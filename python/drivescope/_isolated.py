"""Runs some scenarios in a process of its own: the task comes in, what comes of them goes out."""

import sys

import cloudpickle


def main() -> None:
    runner, work, first, end = cloudpickle.load(sys.stdin.buffer)
    sys.stdout.buffer.write(cloudpickle.dumps(runner(work, first, end)))


if __name__ == "__main__":
    main()
