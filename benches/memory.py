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
        # Of someone who reacts: for a scripted joystick every level but `path` is playback.
        session = ["--scenario", "random:rect:flowing:7", "--seed", "11", "--no-view", "--quiet"]
        works = {
            "recording a simulation": lambda m: [
                "record", *session, "--duration", str(60 * m), "-o", logs[m]
            ]
        }
        replay = ["replay", "--quiet", "--format", "json", "--threads", "1", "--mode"]
        works["open-loop replay"] = lambda m: [*replay, "open", logs[m]]
        # With another controller, so that the levels part from the recording.
        closed = [*replay, "closed", "--controller", "paper-kinematic", "--human"]
        for level in ("playback", "path", "intent", "fitted", "ladder"):
            works[f"closed-loop replay, `{level}`"] = lambda m, level=level: [
                *closed, level, logs[m]
            ]
        works["closed-loop replay, recording controller"] = lambda m: [*replay, "closed", logs[m]]
        for name, arguments in works.items():
            short, long = (peak_mib(*arguments(m)) for m in minutes)
            print(f"| {name} | {short:.1f} | {long:.1f} | {long / short:.2f} |")


if __name__ == "__main__":
    main()
