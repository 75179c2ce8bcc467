#!/usr/bin/env python3
"""How often each controller leaves the static admissible set, and what that costs the person.

    cargo build --release && python3 docs/measure-violations.py [ROOMS]

Records ROOMS (300) random rooms for each kind of room and driver under each controller and sensor
suite, measures them, and prints the table of docs/controller.md. Needs nothing but Python and the
release build; takes some minutes on two cores.
"""

import json
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

TANDEM = Path(__file__).resolve().parent.parent / "target/release/tandem"
DELAY = ":actuator_delay_s=0.1"
SLOW = DELAY + ",limits_acceleration=true,accel_max_mps2=0.3"
ROWS = [
    ("human", "exact", ""),
    ("paper-kinematic", "exact", ""),
    ("tandem-kinematic", "exact", ""),
    ("tandem-kinematic", "exact", SLOW),
    ("paper-dynamic", "exact", ""),
    ("tandem-dynamic", "exact", ""),
    ("tandem-dynamic:control_period_s=0.1", "exact", ""),
    ("tandem-dynamic:control_period_s=0.1", "exact", SLOW),
    ("paper-kinematic", "sonar", DELAY),
    ("tandem-kinematic", "sonar", DELAY),
    ("tandem-kinematic", "sonar", SLOW),
    ("tandem-dynamic", "sonar", DELAY),
    ("tandem-dynamic:control_period_s=0.1", "sonar", DELAY),
    ("tandem-dynamic:control_period_s=0.1", "sonar", SLOW),
]
KINDS = ["rect", "slant", "disc"]
DRIVERS = ["joystick", "goal"]
DURATION_S = 15.0


def run(*arguments: str) -> str:
    return subprocess.run([TANDEM, *arguments], check=True, capture_output=True, text=True).stdout


def cell(controller: str, sensors: str, plant: str, kind: str, driver: str, rooms: int) -> list[dict]:
    with tempfile.TemporaryDirectory() as folder:
        logs = []
        for number in range(1, rooms + 1):
            logs.append(f"{folder}/{number}.mcap")
            run("record", "--quiet", "--no-view", "--sensors", sensors, "--controller", controller,
                "--scenario", f"random:{kind}:{driver}:{number}{plant}", "-o", logs[-1])
        runs = json.loads(run("metrics", "--quiet", "--threads", "1", "--format", "json", *logs))["runs"]
    assert len(runs) == rooms
    metrics = []
    for number, measured in enumerate(runs, 1):
        assert measured["error"] is None, measured
        values = {name: reading["value"] for name, reading in measured["metrics"].items()}
        if values["invariance_breaches"] and controller.startswith("tandem"):
            print(f"left: {controller} {sensors} random:{kind}:{driver}:{number}{plant}", file=sys.stderr)
        metrics.append(values)
    return metrics


def mean(values: list[float]) -> float:
    return sum(values) / len(values)


def main() -> None:
    rooms = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    print("| version, sensors | `rect` | `slant` | `disc` | human share | override | time stuck % | unwarranted % | missed % | switches 1/min |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    with ThreadPoolExecutor(2) as pool:
        for controller, sensors, plant in ROWS:
            pairs = [(kind, driver) for kind in KINDS for driver in DRIVERS]
            cells = dict(zip(pairs, pool.map(lambda p: cell(controller, sensors, plant, *p, rooms), pairs)))
            left = {p: 100 * mean([m["invariance_breaches"] > 0 for m in cells[p]]) for p in pairs}

            def shown_mean(name: str, factor: float, digits: int) -> str:
                """Over all kinds of rooms, for each driver; runs without a value are left out."""
                means = []
                for driver in DRIVERS:
                    values = [m[name] for kind in KINDS for m in cells[kind, driver]]
                    values = [value for value in values if value is not None]
                    means.append(f"{factor * mean(values):.{digits}f}" if values else "–")
                return " / ".join(means)

            shown = [" / ".join(f"{left[kind, driver]:.1f}" for driver in DRIVERS) for kind in KINDS]
            shown.append(shown_mean("human_share", 1, 2))
            shown.append(shown_mean("disagreement", 1, 2))
            shown.append(shown_mean("deadlock_s", 100 / DURATION_S, 1))
            shown.append(shown_mean("unwarranted", 100, 1))
            shown.append(shown_mean("missed", 100, 1))
            shown.append(shown_mean("switches_per_min", 1, 0))
            suite = "exact rays" if sensors == "exact" else "sonars"
            suite += {"": "", DELAY: ", delay", SLOW: ", delay, 0.3 m/s²"}[plant]
            print(f"| `{controller}`, {suite} | " + " | ".join(shown) + " |", flush=True)


if __name__ == "__main__":
    main()
