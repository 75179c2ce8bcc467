#!/usr/bin/env python3
"""Figures of the case studies, and what can be read off them.

    cargo build --release && python3 docs/make-figures.py [--check]

Records each case, draws it with `tandem plot` into docs/figures/, and writes the table between the
marks `figures` in docs/controller.md, section 11. With --check nothing is written; it fails where
that would change anything. Needs nothing but Python and the release build; takes some seconds.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TANDEM = Path(os.environ.get("TANDEM", ROOT / "target/release/tandem"))
PAGE = ROOT / "docs/controller.md"
FIGURES = ROOT / "docs/figures"
BEGIN, END = "<!-- figures: made by docs/make-figures.py -->", "<!-- end of figures -->"
MOST_BYTES = 1_500_000

# Name of the file, what it shows, options of `tandem record`.
CASES = [
    ("case1-human", "I-h: the person alone", "--scenario case1 --controller human"),
    ("case1-kinematic", "I-kin", "--scenario case1"),
    ("case1-dynamic", "I-dyn", "--scenario case1-dynamic --controller tandem-dynamic"),
    ("case2-kinematic", "II-kin", "--scenario case2"),
    ("case2-dynamic", "II-dyn", "--scenario case2-dynamic --controller tandem-dynamic"),
    ("case3-kinematic", "III", "--scenario case3"),
    ("case1-printed", "I as printed", "--scenario case1 --controller paper-kinematic"),
    ("case3-printed", "III as printed", "--scenario case3 --controller paper-kinematic"),
    ("case1-lab", "I in the laboratory, sonars", "--scenario case1-lab"),
    ("case2-lab", "II in the laboratory, sonars", "--scenario case2-lab"),
    ("case3-lab", "III in the laboratory, sonars", "--scenario case3-lab"),
    (
        "case1-lab-dynamic",
        "I in the laboratory, sonars, dynamic",
        "--scenario case1-lab --controller tandem-dynamic",
    ),
]


def run(*arguments: str) -> dict:
    command = [TANDEM, "--quiet", "--format", "json", *arguments]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def stretches(feedback_s: list[list[float]]) -> str:
    """The first three stretches, and how many there are."""
    if not feedback_s:
        return "never"
    shown = ", ".join(f"{begin:.2f}–{end:.2f}" for begin, end in feedback_s[:3])
    return shown if len(feedback_s) <= 3 else f"{shown}, … ({len(feedback_s)} in all)"


def number(value: float | None, digits: int = 3) -> str:
    return "–" if value is None else f"{value:.{digits}f}"


def case(name: str, title: str, options: str, folder: Path) -> tuple[str, str]:
    """The row of the table, and the picture."""
    log, picture = folder / f"{name}.mcap", folder / f"{name}.svg"
    run("record", "--no-view", *options.split(), "-o", str(log))
    facts = run("plot", str(log), "-o", str(picture))
    values = run("metrics", str(log))["runs"][0]["metrics"]
    of = lambda metric: values.get(metric, {}).get("value")  # noqa: E731
    x, y = facts["end_m"]
    least, at = facts["least_clearance_m"], facts["least_clearance_at_s"]
    row = " | ".join([
        f"[{title}](figures/{name}.svg)",
        f"`{options.replace('--scenario ', '').replace('--controller ', '')}`",
        stretches(facts["feedback_s"]),
        number(of("human_share"), 2),
        f"{number(least, 3 if abs(least) > 0.001 else 4)} at {number(at, 1)}",
        number(of("deadlock_s"), 1),
        f"({x:.3f}, {y:.3f})",
    ])
    return f"| {row} |", picture.read_text()


def main() -> None:
    check = sys.argv[1:] == ["--check"]
    rows, pictures = [], {}
    with tempfile.TemporaryDirectory() as folder:
        for name, title, options in CASES:
            row, pictures[f"{name}.svg"] = case(name, title, options, Path(folder))
            rows.append(row)
    size = sum(len(text.encode()) for text in pictures.values())
    assert size < MOST_BYTES, f"{size} bytes of figures"
    block = "\n".join([
        BEGIN,
        "",
        "| figure | scenario, controller | the law drives (s) | human share | least clearance (m, s) "
        "| stuck (s) | end (m) |",
        "|---|---|---|---|---|---|---|",
        *rows,
        "",
        END,
    ])
    page = PAGE.read_text()
    before, rest = page.split(BEGIN)
    after = rest.split(END)[1]
    new_page = before + block + after
    if check:
        stale = [name for name, text in pictures.items()
                 if not (FIGURES / name).is_file() or (FIGURES / name).read_text() != text]
        stale += ["controller.md"] if new_page != page else []
        if stale:
            sys.exit(f"not what this build makes: {', '.join(stale)}")
        return
    FIGURES.mkdir(exist_ok=True)
    for old in FIGURES.glob("*.svg"):
        old.unlink()
    for name, text in pictures.items():
        (FIGURES / name).write_text(text)
    PAGE.write_text(new_page)
    print(f"{len(pictures)} figures, {size} bytes")


if __name__ == "__main__":
    main()
