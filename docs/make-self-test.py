#!/usr/bin/env python3
"""What a comparison notices, measured: the tables between the marks of docs/self-test.md.

    cargo build --release && python3 docs/make-self-test.py [CONTROLLER=ALARMS …]

Runs `tandem compare --self-test` for each controller and writes what it says. Needs nothing but
Python's own library and the release build. By default 200 comparisons with other noise for
`tandem-kinematic` and 20 for `tandem-dynamic`, whose steps are ten times as many.
"""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TANDEM = Path(os.environ.get("TANDEM", ROOT / "target/release/tandem"))
PAGE = ROOT / "docs/self-test.md"
BEGIN, END = "<!-- figures: made by docs/make-self-test.py -->", "<!-- end of figures -->"


def section(controller: str, alarms: str) -> list[str]:
    """Runs it, and says what came of it."""
    began = time.monotonic()
    run = subprocess.run(
        [str(TANDEM), "compare", "--quiet", "--format", "json", "--self-test", "--alarms", alarms, "--a", controller],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )
    if run.returncode not in (0, 1, 3):
        sys.exit(run.stderr)
    test = json.loads(run.stdout)["self_test"]
    print(f"{controller}: {test['reason']} ({time.monotonic() - began:.0f} s)", file=sys.stderr)
    power, noise = test["power"], test["false_alarms"]
    lines = [
        f"### `{controller}`",
        "",
        f"    tandem compare --self-test --alarms {alarms} --a {controller}",
        "",
        f"**{'Passed' if test['passed'] else 'Failed'}**: {test['reason']}.",
        "",
        f"- A against itself differs in {test['differing']['itself']} of {test['sessions']} sessions; renamed and",
        f"  with its parameters in another order in {test['differing']['renamed']}.",
        f"- Mutants caught: {test['caught']} of {len(test['mutants'])} ({test['caught_share']:.3f}; at least 0.95).",
        f"- The gate on the mutants: {power['failed']} fail, {power['undecided']} are undecided,",
        f"  {power['passed']} pass.",
        f"- False alarms of the gate: {noise['alarms']} of {noise['comparisons']} comparisons with other noise",
        f"  ({noise['share']:.3f}; at most 0.05); {noise['undecided']} undecided. The verdict, which looks at every",
        f"  primary metric, says better or worse in {noise['called']} of them, failed in {noise['failed']}.",
        "",
        "| mutant | stage | differs in | stage named in | verdict | gate |",
        "| --- | --- | --: | --: | --- | --- |",
    ]
    for mutant in test["mutants"]:
        named = f"{mutant['named']} of {mutant['differing']}"
        if mutant.get("misnamed"):
            named += ", else " + ", ".join(f"{node} ({n})" for node, n in mutant["misnamed"].items())
        lines.append(
            f"| {mutant['name']} | {' or '.join(mutant['nodes'])} | {mutant['differing']} of {mutant['sessions']} "
            f"| {named} | {mutant['verdict']} | {mutant['gate']} |"
        )
    return [*lines, ""]


def main() -> None:
    asked = sys.argv[1:] or ["tandem-kinematic=200", "tandem-dynamic=20"]
    lines = [line for one in asked for line in section(*one.split("="))]
    before, rest = PAGE.read_text().split(BEGIN)
    after = rest.split(END)[1]
    PAGE.write_text(before + BEGIN + "\n\n" + "\n".join(lines) + "\n" + END + after)


main()
