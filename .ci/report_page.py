"""Opens an HTML report in Chromium and uses it as a reader would. Fails with a sentence.

    python report_page.py REPORT.html [CHROMIUM [FOLDER FOR SCREENSHOTS]]
"""

import math
import re
import sys
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

REPORT = Path(sys.argv[1]).resolve()
BROWSER = sys.argv[2] if len(sys.argv) > 2 and sys.argv[2] else None
PICTURES = Path(sys.argv[3]) if len(sys.argv) > 3 else None
MOST_BYTES = 8_000_000
PLOT_WIDTH = 620.0


def watched(page: Page) -> tuple[list[str], list[str]]:
    """What the page complains of, and what it asks the outside for, from now on."""
    errors: list[str] = []
    requests: list[str] = []
    page.on("console", lambda m: errors.append(m.text) if m.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    return errors, requests


def picture(page: Page, name: str) -> None:
    if PICTURES:
        PICTURES.mkdir(parents=True, exist_ok=True)
        page.screenshot(path=PICTURES / f"report-{name}.jpg", type="jpeg", quality=72)


class Log:
    """One log of the page, and what its own numbers say should be seen."""

    def __init__(self, page: Page, index: int):
        self.page = page
        self.root = page.locator(f"#log-{index} .viewer")
        self.slider = self.root.locator("input[type=range]")
        self.end_s = float(self.root.get_attribute("data-end"))
        place = self.root.locator(".map").get_attribute("data-place")
        self.left, self.top, self.scale = map(float, place.split(","))
        self.rows = {arm: self.read(self.root.get_attribute(f"data-{arm}")) for arm in "ab"}

    @staticmethod
    def read(text: str) -> list[tuple[float, float, float, float]]:
        rows = []
        for row in text.split(";"):
            t, x, y, theta = (float(cell) / 1000 for cell in row.split(",")[:4])
            rows.append((t, x, y, theta))
        return rows

    def time_s(self) -> float:
        return float(self.slider.input_value())

    def expected(self, arm: str, t_s: float) -> tuple[float, float]:
        """Where the robot should be drawn: evenly between the two rows about a time."""
        rows = self.rows[arm]
        before = max((row for row in rows if row[0] <= t_s + 1e-9), default=rows[0])
        after = min((row for row in rows if row[0] > before[0]), default=before)
        share = (t_s - before[0]) / (after[0] - before[0]) if after[0] > before[0] else 0.0
        share = min(max(share, 0.0), 1.0)
        x, y = (before[i] + share * (after[i] - before[i]) for i in (1, 2))
        return (x - self.left) * self.scale, (self.top - y) * self.scale

    def check(self, what: str) -> None:
        """Both robots and every cursor stand where the time says."""
        t_s = self.time_s()
        for arm in "ab":
            moved = self.root.locator(f".robot.r{arm}").get_attribute("transform")
            x, y = map(float, re.fullmatch(r"translate\((\S+) (\S+)\)", moved).groups())
            wanted = self.expected(arm, t_s)
            off = math.hypot(x - wanted[0], y - wanted[1])
            assert off < 0.1, f"{what}: robot {arm} at ({x}, {y}), not at {wanted}, {t_s} s"
        cursors = self.root.locator(".cursor").evaluate_all(
            "all => all.map(cursor => Number(cursor.getAttribute('x1')))")
        assert len(cursors) >= 7, f"{what}: {len(cursors)} cursors"
        wanted = PLOT_WIDTH * t_s / self.end_s
        assert all(abs(x - wanted) < 0.01 for x in cursors), f"{what}: cursors {cursors}, not {wanted}"
        shown = self.root.locator("output").inner_text()
        assert shown == f"{t_s:.2f} s", f"{what}: says {shown} at {t_s} s"


def uses_it(page: Page, errors: list[str], requests: list[str]) -> None:
    page.goto(REPORT.as_uri())
    assert "verdict" in page.locator("header > div").get_attribute("class"), "the verdict stands first"
    log = Log(page, 0)
    log.check("at first")
    still = [log.root.locator(f".robot.r{arm}").get_attribute("transform") for arm in "ab"]

    # A plot, in its middle, and dragged on.
    plot = log.root.locator(".plot:not(.ribbon) svg").first
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 20)
    assert abs(log.time_s() - log.end_s / 2) < log.end_s / 100, f"middle of the plot: {log.time_s()}"
    log.check("plot clicked")
    now = [log.root.locator(f".robot.r{arm}").get_attribute("transform") for arm in "ab"]
    assert all(a != b for a, b in zip(still, now)), "both robots move"
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.75, box["y"] + 30)
    page.mouse.up()
    assert abs(log.time_s() - log.end_s * 0.75) < log.end_s / 100, "dragging goes on"
    log.check("plot dragged")

    # Keys on the slider.
    log.slider.focus()
    page.keyboard.press("Home")
    assert log.time_s() == 0.0, "Home"
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowRight")
    assert abs(log.time_s() - 1.3) < 1e-6, f"arrow keys: {log.time_s()}"
    page.keyboard.press("ArrowLeft")
    assert abs(log.time_s() - 1.2) < 1e-6, "arrow left"
    log.check("keys")
    page.keyboard.press("End")
    assert abs(log.time_s() - log.end_s) < 1e-6, "End"
    log.check("end")

    # The readout says what the rows say.
    said = log.root.locator(".readout tr.a td[data-of=v]").inner_text()
    last = float(log.root.get_attribute("data-a").split(";")[-1].split(",")[6]) / 1000
    assert said == f"{last:.3f}", f"readout {said}, row {last}"

    # Play and pause.
    page.keyboard.press("Home")
    log.root.locator(".play").click()
    page.wait_for_timeout(700)
    log.root.locator(".play").click()
    played = log.time_s()
    assert 0.3 < played < 3.0, f"played to {played} s in 0.7 s"
    page.wait_for_timeout(200)
    assert log.time_s() == played, "a pause is a pause"
    log.check("played")

    # Moments: forwards, backwards, and from the list of all logs into another log.
    wanted = sorted({float(link.get_attribute("data-t"))
                     for link in page.locator("#log-0 .jump").all()})
    if wanted:
        log.slider.focus()
        page.keyboard.press("Home")
        page.keyboard.press("n")
        later = [t for t in wanted if t > 1e-6]
        assert abs(log.time_s() - later[0]) < 1e-6, f"next moment: {log.time_s()}, not {later[0]}"
        log.check("next moment")
        page.keyboard.press("End")
        page.keyboard.press("p")
        assert abs(log.time_s() - later[-1]) < 1e-6, "previous moment"
    links = page.locator("section[aria-labelledby=moments] .jump")
    assert links.count() > 0, "there are moments to click on"
    elsewhere = next((link for link in links.all() if link.get_attribute("data-log") != "0"), links.first)
    index, t_s = int(elsewhere.get_attribute("data-log")), float(elsewhere.get_attribute("data-t"))
    elsewhere.click()
    other = Log(page, index)
    assert page.locator(f"#log-{index}").get_attribute("open") is not None, "a jump opens its log"
    assert abs(other.time_s() - t_s) < 1e-6, f"jumped to {other.time_s()}, not {t_s}"
    other.check("jumped")
    assert other.slider.evaluate("slider => slider === document.activeElement"), "and takes the focus"
    assert other.root.evaluate("root => Math.abs(root.getBoundingClientRect().top) < innerHeight"), "in sight"
    address = page.url
    page.goto("about:blank")
    page.goto(address)
    assert abs(Log(page, index).time_s() - t_s) < 1e-6, f"{address} leads there again"

    for violation in page.locator("section[aria-labelledby=violations] .jump").all()[:3]:
        violation.click()
        log = Log(page, int(violation.get_attribute("data-log")))
        assert abs(log.time_s() - float(violation.get_attribute("data-t"))) < 1e-6, "a violation is found"
    # Everything that can be clicked can be reached by the keyboard.
    reach = page.locator(".jump, button").evaluate_all(
        "all => all.every(it => it.tabIndex >= 0 && (it.matches('button') || it.href))")
    assert reach, "links and buttons only"
    page.locator(".open-all[data-open='1']").click()
    assert page.locator("details.log:not([open])").count() == 0, "all open"
    assert not errors, f"complaints: {errors}"
    outside = [url for url in requests if not url.startswith((REPORT.as_uri(), "about:"))]
    assert not outside, f"requests: {outside}"


def main() -> None:
    size = REPORT.stat().st_size
    assert size <= MOST_BYTES, f"{size} bytes"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        wide = {"width": 1280, "height": 900}

        context = browser.new_context(viewport=wide, offline=True)
        page = context.new_page()
        uses_it(page, *watched(page))
        context.close()

        # Dark, narrow, on paper, without a script.
        looks = [
            ("light", {"viewport": wide}),
            ("dark", {"viewport": wide, "color_scheme": "dark"}),
            ("narrow", {"viewport": {"width": 360, "height": 780}}),
            ("no-script", {"viewport": wide, "java_script_enabled": False}),
        ]
        pages = set()
        for name, options in looks:
            context = browser.new_context(offline=True, **options)
            page = context.new_page()
            errors, _ = watched(page)
            page.goto(REPORT.as_uri())
            if name != "no-script":
                pages.add(page.evaluate("getComputedStyle(document.body).backgroundColor"))
                fits = page.evaluate("document.documentElement.scrollWidth <= innerWidth")
                assert fits, f"{name}: the page is wider than the window"
                log = Log(page, 0)
                log.slider.focus()
                for _ in range(24):
                    page.keyboard.press("Shift+ArrowRight")
                log.check(name)
                log.root.scroll_into_view_if_needed()
                page.evaluate("document.querySelector('#log-0').scrollIntoView()")
            else:
                assert not page.locator("#log-0 .transport").is_visible(), "no script, no slider"
                assert page.locator("#log-0 .map .a").count() == 1, "no script, still a map"
            if name != "no-script":
                picture(page, name)
            assert not errors, f"{name}: {errors}"
            context.close()
        assert len(pages) == 2, f"dark mode is dark: {pages}"

        page = browser.new_context(viewport=wide, offline=True).new_page()
        page.goto(REPORT.as_uri())
        page.emulate_media(media="print")
        assert not page.locator("#log-0 .transport").is_visible(), "no slider on paper"
        paper = page.pdf(format="A4")
        assert len(paper) > 20_000, "something is printed"

        # The check can fail: a script that the policy does not name is refused, and that is noticed.
        changed = REPORT.with_name("changed.html")
        changed.write_text(REPORT.read_text().replace('"use strict";', '"use strict"; void 0;', 1))
        page = browser.new_context(offline=True).new_page()
        errors, _ = watched(page)
        page.goto(changed.as_uri())
        assert errors, "a changed script ran, or nobody noticed that it did not"
        browser.close()
    print(f"ok: {REPORT.name}, {size} bytes")


if __name__ == "__main__":
    try:
        main()
    except AssertionError as error:
        sys.exit(f"FAILED: {error}")
