#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""bus.py BUILD_DIR latency|load: figures of the running system, as rows for docs/benchmarks.md.

latency  40 Hz laser, real time: from LASER to POSE as a third process hears both, all processes running
load     10 Hz laser, real time: CPU share and memory of each process
"""
import os
import pathlib
import re
import subprocess
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import Run, settings  # noqa: E402

DRIVE_S = float(os.environ.get("MODSLAM_BENCH_S", 60))
TICKS = os.sysconf("SC_CLK_TCK")


def share(sorted_values, part):
    return sorted_values[min(len(sorted_values) - 1, int(part * len(sorted_values)))]


def drive(*more):
    """One demo in real time. @return its folder and, for each program, CPU seconds per second and resident MB."""
    folder = system.FOLDER / "run"
    with Run("demo", "--out", folder, *settings("simulator.speed=1", "viewer.port=0", *more)) as run:
        run.until_driving()
        time.sleep(10)
        before, start = cpu(run), time.monotonic()
        time.sleep(DRIVE_S)
        after, seconds = cpu(run), time.monotonic() - start
        memory = {name: resident_mb(pid) for pid, name in run.processes() if name.startswith("modslam-")}
        run.interrupt()
        run.wait(60)
    return folder, {name: ((after[name] - before[name]) / seconds, memory[name]) for name in memory if name in before and name in after}


def cpu(run):
    used = {}
    for pid, name in run.processes():
        if name.startswith("modslam-"):
            fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
            used[name] = (int(fields[11]) + int(fields[12])) / TICKS
    return used


def resident_mb(pid):
    return int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path(f"/proc/{pid}/status").read_text()).group(1)) / 1024


def latency():
    """The recorder stamps what it hears; between the LASER and the POSE of one time lies what the robot waits for."""
    folder, _ = drive("laser.rate_hz=40", "odometry.rate_hz=100")  # so that no scan waits for odometry of its time
    heard, waits_ms = {}, []
    for utime, channel, data in system.events(folder / "run.lcm"):
        stamp = int.from_bytes(data[8:16], "big") if channel in ("LASER", "POSE") else None
        if channel == "LASER":
            heard[stamp] = utime
        elif channel == "POSE" and stamp in heard:
            waits_ms.append(1e-3 * (utime - heard[stamp]))
    waits_ms.sort()
    print(f"| from LASER to POSE at 40 Hz, {len(waits_ms)} scans: p50, p99, largest | {share(waits_ms, 0.5):.2f}, {share(waits_ms, 0.99):.2f}, "
          f"{waits_ms[-1]:.1f} ms |")
    print(f"| the machine's load meanwhile (processes that want one of its {os.cpu_count()} cores) | {os.getloadavg()[0]:.1f} |")


def load():
    _, used = drive("laser.rate_hz=10")
    simulated = ("modslam-simulator", "modslam-laser", "modslam-odometry", "modslam-ins")
    print(f"| CPU of all processes at 10 Hz, and without the simulated world | {100 * sum(part for part, _ in used.values()):.1f}, "
          f"{100 * sum(part for name, (part, _) in used.items() if name not in simulated):.1f} % of one core |")
    for name, (part, memory) in sorted(used.items()):
        print(f"| {name} at 10 Hz | {100 * part:.1f} %, {memory:.0f} MB |")


if __name__ == "__main__":
    question = {"latency": latency, "load": load}[sys.argv.pop(2)]
    system.TESTS.clear()
    system.test("measured")(question)
    system.main()
