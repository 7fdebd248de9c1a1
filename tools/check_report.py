"""Opens a report from its file in headless chromium and checks what a reader would see.

    python tools/check_report.py REPORT.html [SCREENSHOT.png]

The browser is DRIVESCOPE_CHROMIUM, or `chromium`. Exit status 1 if something is wrong.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

MOST_BYTES = 3_000_000
SECONDS = 120
FAULTS = 12


def chromium(*arguments):
    """Runs the browser headless on a profile of its own; its standard output and error."""
    with tempfile.TemporaryDirectory() as profile:
        command = [
            os.environ.get("DRIVESCOPE_CHROMIUM", "chromium"),
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--enable-logging=stderr",
            f"--user-data-dir={profile}",
            *arguments,
        ]
        done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, check=True)
    return done.stdout, done.stderr


def main():
    report = Path(sys.argv[1]).resolve()
    wrong = []
    if report.stat().st_size > MOST_BYTES:
        wrong.append(f"it has {report.stat().st_size} bytes, more than {MOST_BYTES}")
    page, log = chromium("--dump-dom", report.as_uri())
    console = [line for line in log.splitlines() if "CONSOLE" in line]
    wrong += [f"the console is not silent: {line}" for line in console]
    plots = page.count("<svg")
    if plots < FAULTS:
        wrong.append(f"it shows {plots} plots, fewer than the {FAULTS} faults")
    outside = re.findall(r'(?:src|href)="(?:https?:)?//[^"]*', page)
    wrong += [f"it loads from outside: {link}" for link in outside]
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(sys.argv[2] if len(sys.argv) > 2 else Path(folder) / "report.png")
        chromium(f"--screenshot={picture}", "--window-size=1280,3000", report.as_uri())
        if picture.stat().st_size < 20_000:
            wrong.append("its screenshot is nearly empty")
    for problem in wrong:
        print(f"{report.name}: {problem}")
    print(f"{report.name}: {plots} plots, {report.stat().st_size} bytes, {len(wrong)} problems")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
