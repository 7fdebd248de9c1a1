"""Drives the local page in headless chromium as a user would, and checks what comes of it.

    python tools/check_page.py [--timed] PROGRAM [PICTURES]

PROGRAM is the built drivescope. Into the folder PICTURES, if it is given, go the screenshots that
the README shows. The browser is DRIVESCOPE_CHROMIUM, or `chromium`. Exit status 1 if something is
wrong; figures are printed with their limits. Those in milliseconds are judged only with --timed,
on a machine that does nothing else: a busy one says nothing about the page.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import fmpy
import fmpy.validation
from playwright.sync_api import expect, sync_playwright

EXAMPLE = Path(__file__).parent.parent / "docs" / "worked-example"
INPUTS = {
    "one.csv": ("8 * sin(2 * t) + 5 * sin(7 * t) + 4 * sign(sin(11 * t))", 3),
    "two.csv": ("9 * sin(1.7 * t) + 6 * sign(sin(9 * t))", 4),
}
HIDDEN = "cogging"
# Length of a simulated recording, s.
DURATION = 5
# An address that holds a window of time.
WINDOW = re.compile(r"#.*from=")
FLOOR = 1.0
NEAR_THE_FLOOR = 1.1
# A recording of 1e5 samples: how long it may take to see it, and the memory of a server that has
# nothing else.
SAMPLES_S = 100
FIRST_VIEW_MS = 300
DRAWN_MS = 150
MEMORY_MB = 300
PATIENCE_MS = 90_000
WIDE = {"width": 1280, "height": 900}
MIDDLE = {"width": 800, "height": 900}
NARROW = {"width": 400, "height": 860}


class Check:
    """What was found wrong, and the figures."""

    def __init__(self, timed):
        self.timed = timed
        self.wrong = []

    def that(self, holds, words):
        if not holds:
            self.wrong.append(words)
            print(f"page: WRONG: {words}")

    def figure(self, name, value, limit, unit):
        print(f"page: {name}: {value:.1f} {unit} (at most {limit})")
        judged = unit != "ms" or self.timed
        over = f"{name} is {value:.1f} {unit}, more than {limit}"
        self.that(not judged or value <= limit, over)


class Server:
    """A running `drivescope serve`."""

    def __init__(self, program, folder, *arguments):
        self.program = program
        command = [program, "serve", "--quiet", *arguments]
        self.process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()

    def memory_mb(self):
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(r"VmHWM:\s+(\d+) kB", status)[1]) / 1000

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(timeout=10)


def simulate(program, folder, name, drive, text, seed, duration=DURATION):
    command = [program, "simulate", drive, "--input", text, "--period", "0.001", "--quiet"]
    command += ["--duration", str(duration), "--seed", str(seed), "-o", name]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)


def watched(context, check, host):
    """A page whose console must stay silent, and that loads nothing from outside."""
    page = context.new_page()
    page.set_default_timeout(PATIENCE_MS)
    page.on("console", lambda it: check.that(False, f"the console says {it.text}"))
    page.on("pageerror", lambda it: check.that(False, f"a script fails: {it}"))

    def asked(request):
        own = request.url.startswith((f"http://{host}", "blob:", "data:", "file://"))
        check.that(own, f"it loads {request.url}")

    page.on("request", asked)
    return page


def fits(page, check, words):
    """Nothing leaves the page sideways."""
    over = page.evaluate("document.documentElement.scrollWidth - innerWidth")
    check.that(over <= 0, f"{words}: it is {over} px wider than the window")


def at_rest(page):
    expect(page.locator("#status")).to_be_hidden(timeout=PATIENCE_MS)


def errors(page, step):
    cells = page.locator(f"#ladder tr[data-step='{step}'] td").all_inner_texts()
    # What can be done stands last.
    estimation, validation = cells[-3:-1]
    return float(estimation), float(validation)


def save(page, words, folder):
    with page.expect_download() as download:
        page.get_by_role("link", name=words, exact=True).click()
    path = Path(folder) / download.value.suggested_filename
    download.value.save_as(path)
    return path


def picture(page, pictures, name):
    if pictures:
        page.screenshot(path=pictures / name)


def walk(page, server, check, folder, pictures):
    """Drop, see, learn, add, take along."""
    page.goto(server.url)
    page.locator("#file").set_input_files([Path(folder) / name for name in ("model.toml", *INPUTS)])
    page.locator("#see").wait_for()
    at_rest(page)
    check.that(page.locator("#spans li").count() > 0, "no failing span is shown")
    first = page.locator(".card").first
    check.that(first.get_attribute("data-effect") == HIDDEN, "the right card is not the first")
    before = errors(page, 0)
    page.locator("#see").scroll_into_view_if_needed()
    page.locator("#see-h").evaluate("it => it.scrollIntoView()")
    picture(page, pictures, "see.png")
    page.locator("#learn-h").evaluate("it => it.scrollIntoView()")
    picture(page, pictures, "learn.png")
    # A span is brushed by a click, and everything follows; the address holds it.
    page.locator("#spans button").first.click()
    page.locator("#within section").wait_for()
    check.that("from=" in page.url, "the address does not hold the window")
    page.reload()
    page.locator("#within section").wait_for()
    check.that(page.locator(".card").count() > 0, "the state is lost on reload")
    page.locator("#zoom-out").click()
    dragged(page, check)
    # A law of one's own, wrong and right.
    page.get_by_text("A law of your own").click()
    page.locator("#law [name=text]").fill("-c * omega * abs(speed)")
    expect(page.locator("#law-said")).to_contain_text("`speed` is unknown")
    page.locator("#law [name=text]").fill("-c * omega * abs(omega)")
    expect(page.locator("#law-said")).to_contain_text("Understood")
    # A second tab of the same session sees what the first one does.
    tab = watched(page.context, check, re.search("//(.*?)/", page.url)[1])
    tab.goto(page.url)
    tab.locator("#ladder tr[data-step='0']").wait_for()
    # One click, and the error falls.
    page.locator(".card .add").first.click()
    page.locator("#ladder tr[data-step='1']").wait_for()
    at_rest(page)
    after = errors(page, 1)
    floor = NEAR_THE_FLOOR * FLOOR
    check.that(max(after) < floor < before[1], f"the error falls from {before} to {after} only")
    check.that("step=1" in page.url, "the page does not go to the new step")
    tab.locator("#ladder tr[data-step='1']").wait_for()
    check.that("step=1" not in tab.url, "the other tab is taken along")
    tab.close()
    page.locator("#add-h").evaluate("it => it.scrollIntoView()")
    picture(page, pictures, "add.png")
    for fmi in (2, 3):
        fmu = save(page, f"FMU, FMI {fmi}.0", folder)
        result = fmpy.simulate_fmu(str(fmu), stop_time=0.1, timeout=60)
        check.that(len(result) > 1, f"fmpy does not run {fmu.name}")
    text = save(page, "Drive file", folder).read_text()
    check.that(HIDDEN in text, "the drive file does not have the effect")
    return save(page, "Report", folder)


def dragged(page, check):
    """A window dragged with the mouse is the window that is shown, in every plot."""
    plots = page.locator(".uplot .u-over")
    check.that(plots.count() > 1, "there is one plot only")
    for number in range(plots.count()):
        plot = plots.nth(number)
        plot.scroll_into_view_if_needed()
        box = plot.bounding_box()
        middle = box["y"] + box["height"] / 2
        page.mouse.move(box["x"] + 0.2 * box["width"], middle)
        page.mouse.down()
        page.mouse.move(box["x"] + 0.5 * box["width"], middle, steps=5)
        page.mouse.move(box["x"] + 0.7 * box["width"], middle, steps=5)
        page.mouse.up()
        expect(page).to_have_url(WINDOW)
        window = re.search(r"from=([-\d.e]+)&to=([-\d.e]+)", page.url)
        begin, end = float(window[1]), float(window[2])
        # A run of 5 s: half of it, from a fifth on.
        right = abs(begin - 0.2 * DURATION) < 0.1 and abs(end - 0.7 * DURATION) < 0.1
        check.that(right, f"plot {number}: {begin} to {end} s for 1 to 3.5 s that were dragged")
        page.locator("#zoom-out").click()
        expect(page).not_to_have_url(WINDOW)


def keyboard(page, check):
    """What can be done by mouse can be reached without."""
    page.evaluate("document.activeElement.blur(); scrollTo(0, 0)")
    reached = set()
    for _ in range(90):
        page.keyboard.press("Tab")
        reached.add(
            page.evaluate("(it => it.dataset.do || it.id || it.className)(document.activeElement)")
        )
    for wanted in ("file", "example", "recording", "ghost", "from", "to"):
        check.that(wanted in reached, f"`{wanted}` is not reached by keyboard")
    unnamed = page.evaluate(
        """[...document.querySelectorAll('svg.plot, .uplot')].filter(it =>
            !it.querySelector('title') && !it.getAttribute('aria-label')).length"""
    )
    check.that(unnamed == 0, f"{unnamed} pictures have no text in their place")


def wrong_unit(page, server, check, folder):
    """A speed in rpm under a header of rad/s is seen at once and corrected by a click."""
    lines = (Path(folder) / "one.csv").read_text().splitlines()
    head = lines[0].split(",")
    omega = head.index("omega [rad/s]")
    kept = [head.index(name) for name in ("time [s]", "u [V]", "i [A]", "omega [rad/s]")]
    rows = [",".join(head[k] for k in kept)]
    for line in lines[1:]:
        cells = line.split(",")
        cells[omega] = repr(float(cells[omega]) * 9.549296585513721)
        rows.append(",".join(cells[k] for k in kept))
    path = Path(folder) / "rpm.csv"
    path.write_text("\n".join(rows) + "\n")
    page.goto(re.sub(r"/\?.*", "/", server.url))
    page.locator("#file").set_input_files([Path(folder) / "model.toml", path])
    offer = page.locator(".offer button").first
    expect(offer).to_have_text("Take omega as rpm")
    offer.click()
    page.locator("#see").wait_for()
    check.that(page.locator(".offer").count() == 0, "the offer stays after the correction")


def mapped(page, server, check, folder, pictures):
    """A log with names of its own and a time without a unit: said in words, read at once."""
    lines = (Path(folder) / "one.csv").read_text().splitlines()
    head = lines[0].split(",")
    kept = [head.index(name) for name in ("time [s]", "u [V]", "omega [rad/s]")]
    # The time stands second: a first column that runs like a clock is taken without a word.
    rows = ["Steller,Marke,Welle"]
    for line in lines[1:]:
        time, u, omega = (float(line.split(",")[k]) for k in kept)
        rows.append(f"{u!r},{1000 * time!r},{omega * 9.549296585513721!r}")
    path = Path(folder) / "foreign.csv"
    path.write_text("\n".join(rows) + "\n")
    page.goto(re.sub(r"/\?.*", "/", server.url))
    page.locator("#file").set_input_files(path)
    page.get_by_text("foreign.csv is to be completed.").wait_for()
    check.that(page.locator("svg.spark").count() == 3, "a column has no small plot")
    picture(page, pictures, "incomplete.png")
    page.get_by_role("button", name="Take `Marke` as time in ms").click()
    shaft = page.locator("tr[data-column='Welle']")
    expect(shaft.locator(".makes")).to_have_text("")
    page.get_by_label("what column Steller is").select_option(
        label="armature voltage or drive command, u"
    )
    expect(page.locator("tr[data-column='Steller'] .makes")).to_contain_text("V")
    page.get_by_label("what column Welle is").select_option(label="speed of the shaft, omega")
    expect(shaft.locator(".makes")).to_contain_text("rad/s")
    before = shaft.locator(".makes").inner_text()
    unit = page.get_by_label("unit of column Welle")
    unit.fill("rpm")
    unit.press("Enter")
    expect(shaft.locator(".makes")).not_to_have_text(before)
    page.locator("#see").wait_for()
    at_rest(page)
    page.locator("#drop-h").evaluate("it => it.scrollIntoView()")
    picture(page, pictures, "columns.png")
    # The sampling time, by a button.
    asked = page.locator("form.sampling[data-what=resample]")
    asked.locator("input").fill("2")
    asked.get_by_role("button").click()
    expect(page.locator("details.recording summary")).to_contain_text("every 2 ms")
    page.get_by_role("button", name="As it was sampled").wait_for()
    fits(page, check, "columns")
    page.set_viewport_size(NARROW)
    # The plots follow the window a moment later.
    page.wait_for_timeout(1000)
    fits(page, check, "columns, narrow")
    page.set_viewport_size(WIDE)


def begin(page, server, folder, *names):
    """A session of its own with these files, until the model is seen beside them."""
    page.goto(re.sub(r"/\?.*", "/", server.url))
    page.locator("#file").set_input_files([Path(folder) / name for name in names])
    page.locator("#see").wait_for()


def large(page, server, check, folder):
    """1e5 samples: how soon they are seen, and the memory that the whole loop takes."""
    begin(page, server, folder, "model.toml", "long.csv")
    expect(page.locator("body")).to_have_attribute("data-first-view-ms", re.compile("."))
    data = page.evaluate("({...document.body.dataset})")
    check.figure("first view of 1e5 samples", float(data["firstViewMs"]), FIRST_VIEW_MS, "ms")
    page.locator("[data-do=cancel]").click()
    at_rest(page)
    drawn = page.evaluate(
        """async () => {
            const { dataset } = document.body;
            delete dataset.drawnMs;
            const again = new Event('change', { bubbles: true });
            document.getElementById('recording').dispatchEvent(again);
            while (!dataset.drawnMs) await new Promise(requestAnimationFrame);
            return Number(dataset.drawnMs);
        }"""
    )
    check.figure("drawing 1e5 points of every signal", drawn, DRAWN_MS, "ms")
    begin(page, server, folder, "model.toml", "long.csv")
    at_rest(page)
    page.locator(".card .add").first.click()
    page.locator("#ladder tr[data-step='1']").wait_for()
    at_rest(page)
    check.figure("memory of the server", server.memory_mb(), MEMORY_MB, "MB")


def report(context, check, path):
    """The same frozen in a file: of the page, and of the command line."""
    page = watched(context, check, "nowhere")
    page.goto(path.as_uri())
    check.that(page.locator("svg.plot").count() > 5, "the report shows few plots")
    check.that(page.locator(".card").first.get_attribute("data-effect") == HIDDEN, "report's card")
    fits(page, check, "report")
    size = path.stat().st_size
    check.figure("report of the loop", size / 1e6, 3, "MB")
    page.close()


def looks(page, check):
    """Narrow and wide, dark and light: nothing leaves the page."""
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        for size, width in ((WIDE, "wide"), (NARROW, "narrow")):
            page.set_viewport_size(size)
            page.locator("#see-h").evaluate("it => it.scrollIntoView()")
            page.wait_for_timeout(150)
            fits(page, check, f"{scheme}, {width}")
    page.emulate_media(color_scheme="light")
    page.set_viewport_size(WIDE)


def faults(page, server, check, pictures):
    """The study from the page: live progress, its answer, from a fault to its run on a click."""
    page.goto(re.sub(r"/\?.*", "/", server.url))
    page.get_by_role("button", name="Faults").click()
    page.get_by_role("button", name="Run the study").click()
    page.locator("#study progress").wait_for()
    rows = page.locator("#detection > div.scroll").first.locator("tbody tr")
    rows.first.wait_for()
    check.that(rows.count() == 12, "the table of detection has not 12 faults")
    fault = page.locator("#detection tbody a").first
    run = fault.get_attribute("href")
    fault.click()
    expect(page.locator(run)).to_be_in_viewport()
    expect(page.locator(f"{run} ~ figure svg").first).to_be_visible()
    check.that(page.locator("#isolation table").count() > 0, "no isolation matrix is shown")
    fits(page, check, "faults")
    page.locator("#detection-h").evaluate("it => it.scrollIntoView()")
    picture(page, pictures, "faults.png")


def diagnosed(program, folder):
    """Two healthy runs of the laboratory rig, and one whose tachometer fails."""
    usual = [program, "simulate", "dr300", "--reference", "2000 [rpm]", "--quiet"]
    for name, seed, more in (
        ("healthy1.csv", 1, ["--duration", "20"]),
        ("healthy2.csv", 2, ["--duration", "20"]),
        ("ill.csv", 3, ["--duration", "12", "--fault", "tacho=5%@8..10"]),
    ):
        run = [*usual, "--seed", str(seed), *more, "-o", name]
        subprocess.run(run, cwd=folder, check=True, capture_output=True)


def diagnose(page, server, check, folder, pictures):
    """Train on one's own log and watch another: verdict, figure, declared faults."""
    diagnosed(server.program, folder)
    page.goto(re.sub(r"/\?.*", "/", server.url))
    # The drive that the diagnoser is to know: fitted where models and measurements are.
    page.get_by_role("button", name="Diagnose").click()
    page.locator("#diagnose").get_by_text("Train", exact=True).wait_for()
    for place, names in (
        ("#healthy-file", ["healthy1.csv", "healthy2.csv"]),
        ("#watched-file", ["ill.csv"]),
    ):
        page.locator(place).set_input_files([Path(folder) / name for name in names])
        expect(page.locator("#diagnosis tbody")).to_contain_text(names[-1])
    rows = page.locator("#diagnosis tbody tr").count()
    check.that(rows == 3, f"{rows} recordings are listed, 3 were dropped")
    # By keyboard alone.
    page.evaluate("document.activeElement.blur(); scrollTo(0, 0)")
    reached = set()
    for _ in range(30):
        page.keyboard.press("Tab")
        reached.add(
            page.evaluate(
                "(it => it.dataset.diagnose || it.id || it.className)(document.activeElement)"
            )
        )
        if "train" in reached:
            break
    for wanted in ("healthy-file", "watched-file", "mark", "remove", "train"):
        check.that(wanted in reached, f"`{wanted}` is not reached by keyboard")
    page.keyboard.press("Enter")
    verdict = page.locator("[data-verdict]")
    expect(verdict).to_have_attribute("data-verdict", "fault", timeout=PATIENCE_MS)
    at_rest(page)
    table = page.get_by_role("table", name="Declared faults").locator("tbody tr").first
    begin = float(table.locator("th").first.inner_text())
    check.that(abs(begin - 8) < 0.1, f"the fault of 8 s is declared from {begin} s")
    check.that(
        page.locator("#diagnose svg.plot").count() == 1, "there is no figure of the watched run"
    )
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        for size, width in ((WIDE, "wide"), (MIDDLE, "800"), (NARROW, "narrow")):
            page.set_viewport_size(size)
            page.wait_for_timeout(150)
            fits(page, check, f"diagnosis, {scheme}, {width}")
            if pictures:
                page.screenshot(path=pictures / f"diagnosis_{scheme}_{width}.png", full_page=True)
    page.emulate_media(color_scheme="light")
    page.set_viewport_size(WIDE)
    path = save(page, "Diagnoser file", folder)
    said = subprocess.run(
        [server.program, "diagnose", str(path), "ill.csv", "--quiet"],
        cwd=folder,
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    check.that("fault" in said, "the diagnoser of the page finds nothing on the command line")
    fmu = save(page, "FMU, FMI 3.0", folder)
    problems = fmpy.validation.validate_fmu(str(fmu))
    check.that(not problems, f"the diagnoser's FMU: {problems}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=Path)
    parser.add_argument("pictures", type=Path, nargs="?")
    parser.add_argument("--timed", action="store_true")
    asked = parser.parse_args()
    program, pictures = str(asked.program.resolve()), asked.pictures
    check = Check(asked.timed)
    browser_path = shutil.which(os.environ.get("DRIVESCOPE_CHROMIUM", "chromium"))
    flags = ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        shutil.copy(EXAMPLE / "model.toml", folder)
        for name, (text, seed) in INPUTS.items():
            simulate(program, folder, name, EXAMPLE / "machine.toml", text, seed)
        text = INPUTS["one.csv"][0]
        simulate(program, folder, "long.csv", EXAMPLE / "machine.toml", text, 5, SAMPLES_S)
        browser = playwright.chromium.launch(executable_path=browser_path, args=flags)
        context = browser.new_context(viewport=WIDE, accept_downloads=True, reduced_motion="reduce")
        with Server(program, folder) as server:
            page = watched(context, check, re.search("//(.*?)/", server.url)[1])
            kept = walk(page, server, check, folder, pictures)
            keyboard(page, check)
            looks(page, check)
            report(context, check, kept)
            run = [program, "discover", "model.toml", *INPUTS, "--out", "found.html", "--quiet"]
            subprocess.run(run, cwd=folder, check=True, capture_output=True)
            report(context, check, Path(folder) / "found.html")
            wrong_unit(page, server, check, folder)
            mapped(page, server, check, folder, pictures)
            diagnose(page, server, check, folder, pictures)
            faults(page, server, check, pictures)
            # Before the server: the page would say that it is gone.
            page.close()
        # In a server of its own: the sessions before it would count as its memory.
        with Server(program, folder) as server:
            page = watched(context, check, re.search("//(.*?)/", server.url)[1])
            page.goto(server.url)
            large(page, server, check, folder)
            page.close()
        browser.close()
    print(f"page: {len(check.wrong)} problems")
    sys.exit(1 if check.wrong else 0)


if __name__ == "__main__":
    main()
