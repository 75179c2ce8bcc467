#!/usr/bin/env python3
"""The laws as printed against the corrected ones, over simulated people: docs/flagship.md.

    cargo build --release && python3 docs/make-flagship.py [--sessions N] [--folder DIR]

Records N sessions (120) with each law as printed, brings their people back by every level of the ladder,
and compares. Needs nothing but Python's own library. The reports stay in DIR (flagship-report/):
report.html and its companions for both models.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import textwrap
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TANDEM = Path(os.environ.get("TANDEM", ROOT / "target/release/tandem"))
KINDS = ["rect:goal", "rect:joystick", "slant:goal", "slant:joystick", "disc:goal", "disc:joystick"]
PAIRS = {
    "kinematic": ("paper-kinematic", "tandem-kinematic"),
    "dynamic": ("paper-dynamic", "tandem-dynamic"),
}
# What the page shows; the reports have every metric.
SHOWN = {
    "safety": ["collisions", "invariance_breaches", "min_clearance_m", "near_miss_s", "ttc_exposure_s"],
    "authority": [
        "human_share", "interventions_per_min", "chatter_per_min", "deadlock_s", "override_m",
        "unwarranted", "excess",
    ],
    "comfort": ["accel_rms_mps2", "jerk_rms_mps3", "angular_jerk_rms_radps3", "sparc"],
    "task": ["tracking_rms_m", "path_efficiency"],
}
KIND_WORDS = {
    "left_admissible_set": "leaving the admissible set",
    "collision_disc_active": "moving towards someone in contact",
}


def tandem(*arguments: str) -> int:
    run = subprocess.run([str(TANDEM), *arguments], cwd=ROOT, stdout=subprocess.DEVNULL, check=False)
    return run.returncode


def record(folder: Path, controller: str, count: int) -> list[str]:
    """Sessions of one controller, a seed of their own each."""
    logs = []
    (folder / controller).mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(2) as pool:
        runs = []
        for number in range(count):
            kind, room = KINDS[number % len(KINDS)], number // len(KINDS) + 1
            # Reports name logs as they are given: from the root of the project, wherever that is.
            log = os.path.relpath(folder / controller / f"{kind.replace(':', '-')}-{room}.mcap", ROOT)
            logs.append(log)
            runs.append(pool.submit(
                tandem, "record", "--quiet", "--no-view", "--force", "--scenario", f"random:{kind}:{room}",
                "--controller", controller, "--seed", str(number + 1), "-o", log,
            ))
        if any(run.result() for run in runs):
            sys.exit(f"recording with {controller} failed")
    return logs


def breaches(result: dict) -> list[str]:
    """What B alone did at every level of the ladder, each once."""
    seen = {}
    for one in result["violations"]:
        if one["new"] and not one["possible"]:
            seen.setdefault((one["log"], one["kind"]), one)
    return [
        f"{KIND_WORDS.get(kind, kind)} in `{Path(log).stem}` at {one['t_s']:.2f} s ({1000 * one['depth_m']:.0f} mm deep,"
        f" at {one['speed_mps']:.2f} m/s as it began)"
        for (log, kind), one in seen.items()
    ]


def number(x: float | None) -> str:
    if x is None:
        return "–"
    size = abs(x)
    if size == int(size) and size < 1e6:
        return f"{x:.0f}"
    return f"{x:.3f}" if size < 10 else f"{x:.2f}" if size < 100 else f"{x:.1f}"


def change(metric: dict) -> str:
    if metric["delta"] is None:
        return "–"
    sign = lambda x: ("+" if x > 0 else "") + number(x)
    mark = "=" if metric["delta"] == 0 else "○"
    if metric["decidable"]:
        mark = "▲" if (metric["delta"] > 0) == (metric["better"] == "higher") else "▼"
    ci = metric["ci"]
    return f"{mark} {sign(metric['delta'])}" + (f" [{sign(ci[0])}, {sign(ci[1])}]" if ci else "")


def table(results: dict[str, dict]) -> list[str]:
    lines = [
        "| | paper-kinematic | tandem-kinematic | change | paper-dynamic | tandem-dynamic | change |",
        "| --- | --: | --: | --- | --: | --: | --- |",
    ]
    for group, names in SHOWN.items():
        lines.append(f"| **{group}** | | | | | | |")
        for name in names:
            cells = []
            unit = ""
            for model in PAIRS:
                metric = next(m for m in results[model]["metrics"] if m["name"] == name)
                unit = f" ({metric['unit']})" if metric["unit"] else ""
                cells += [number(metric["a"]), number(metric["b"]), change(metric)]
            lines.append(f"| {name}{unit} | {' | '.join(cells)} |")
    return lines


def left(result: dict, arm: str) -> int:
    """In how many logs an arm leaves the admissible set at some level."""
    return len({v["log"] for v in result["violations"]
                if v["arm"] == arm and v["kind"] == "left_admissible_set"})


def picture(report: Path, name: str) -> None:
    """The head of a report as a reader sees it; without a browser the picture stays as it is."""
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if browser is None:
        print("no Chromium: pictures are left as they are", file=sys.stderr)
        return
    picture = ROOT / f"docs/report/flagship-{name}.png"
    subprocess.run(
        [browser, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--window-size=1400,1700",
         f"--screenshot={picture}", report.as_uri()],
        check=True, capture_output=True,
    )


def main() -> None:
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--sessions", type=int, default=120)
    arguments.add_argument("--folder", type=Path, default=ROOT / "flagship-report")
    arguments.add_argument("--human", default="ladder")
    options = arguments.parse_args()
    options.folder = options.folder.resolve()
    if not TANDEM.exists():
        sys.exit(f"{TANDEM} is not there: build it first, cargo build --release")
    began = time.monotonic()
    results = {}
    for model, (a, b) in PAIRS.items():
        logs = record(options.folder, a, options.sessions)
        report = options.folder / model
        status = tandem("compare", "--quiet", "--force", "--a", a, "--b", b, "--human", options.human,
                        "--report", str(report), *logs)
        if status not in (0, 1, 3):
            sys.exit(f"comparing {a} with {b} could not be done")
        results[model] = json.loads((report / "report.json").read_text())
        size = (report / "report.html").stat().st_size / 1e6
        print(f"{model}: {results[model]['verdict']}, {size:.1f} MB, {time.monotonic() - began:.0f} s",
              file=sys.stderr)
    print(f"recorded and compared in {time.monotonic() - began:.0f} s", file=sys.stderr)
    for model in PAIRS:
        picture(options.folder / model / "report.html", model)
    page = [
        "# The paper's question: what do the corrections buy, and what do they cost?",
        "",
        "The laws as printed against the corrected ones with their safety layer, for both models, on the same",
        f"people: {options.sessions} random rooms (rectangular, slanted, with walking people; people who head for a",
        "goal and people who move the joystick at random), sixteen faulty sonars, a seed of noise for each session.",
        "Every session is recorded with the law as printed, and its person brought back by every level of the",
        "ladder; figures are means of the levels that estimate, changes are called (▲ ▼) only where no level",
        "contradicts them.",
        "",
        "    cargo build --release && python3 docs/make-flagship.py",
        "",
        "makes this page and both reports (two HTML pages with every run to look at, in `flagship-report/`).",
        "",
    ]
    for model, (a, b) in PAIRS.items():
        result = results[model]
        page += [
            *textwrap.wrap(
                f"**`{b}` against `{a}`: {result['verdict']}.** {result['reason']}. Of {len(result['logs'])} sessions"
                f" ({sum(log['status'] == 'failed' for log in result['logs'])} failed) the robot leaves the admissible"
                f" set at some level of the ladder in {left(result, 'a')} with `{a}`, in {left(result, 'b')} with"
                f" `{b}`.",
                width=104, break_on_hyphens=False, break_long_words=False,
            ),
            "",
        ]
        if alone := breaches(result):
            page += [
                *textwrap.wrap(
                    f"What `{b}` alone does at every level of the ladder, which fails a comparison however good the rest"
                    f" is: {'; '.join(alone)}.",
                    width=104, break_on_hyphens=False, break_long_words=False,
                ),
                "",
            ]
    page += table(results)
    page += [
        "",
        "▲ better, ▼ worse, ○ within chance, = no change; in brackets the 95 % interval over sessions.",
        "`collisions` counts people who walk into a robot that does not move towards them; `invariance_breaches`",
        "is about what stands still.",
        "",
        "![The head of the report on the kinematic law: verdict, facts and metrics with their",
        "intervals](report/flagship-kinematic.png)",
        "",
        "![The head of the report on the dynamic law](report/flagship-dynamic.png)",
    ]
    (ROOT / "docs/flagship.md").write_text("\n".join(page) + "\n")


main()
