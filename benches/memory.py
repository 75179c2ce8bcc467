#!/usr/bin/env python3
"""Peak memory of recording and replaying ten minutes and an hour (needs Linux and a release build).

    cargo build --release && python3 benches/memory.py
"""

import os
import subprocess
import sys
import tempfile
import time

PROGRAM = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "target/release/tandem")


def peak_mib(*arguments):
    """The largest resident size that the kernel tells of the program, asked until it ends: what `wait4`
    tells would hold the size of this script too."""
    process = subprocess.Popen([PROGRAM, *arguments], stdout=subprocess.DEVNULL)
    peak_kib = 0
    while process.poll() is None:
        with open(f"/proc/{process.pid}/status") as status:
            for line in status:
                if line.startswith("VmHWM:"):
                    peak_kib = max(peak_kib, int(line.split()[1]))
        time.sleep(0.005)
    assert process.returncode == 0, arguments
    return peak_kib / 1024


def main():
    print("| work | 10 min, MiB | 1 h, MiB | ratio |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        minutes = (10, 60)
        logs = {m: os.path.join(folder, f"{m}.mcap") for m in minutes}
        session = ["--scenario", "random:rect:joystick:7", "--seed", "11", "--no-view", "--quiet"]
        works = {
            "recording a simulation": lambda m: [
                "record", *session, "--duration", str(60 * m), "-o", logs[m]
            ]
        }
        for mode in ("open", "closed"):
            works[f"{mode}-loop replay"] = lambda m, mode=mode: [
                "replay", "--quiet", "--format", "json", "--threads", "1", "--mode", mode, logs[m]
            ]
        for name, arguments in works.items():
            short, long = (peak_mib(*arguments(m)) for m in minutes)
            print(f"| {name} | {short:.1f} | {long:.1f} | {long / short:.2f} |")


if __name__ == "__main__":
    main()
