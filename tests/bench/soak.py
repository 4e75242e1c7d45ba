#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""soak.py BUILD_DIR: passes over one log in one life of all processes; what each process needs in each pass, as rows for docs/benchmarks.md.

A pass drives the log to its end and the same way back, so that it ends where it began, as often as it takes to fill an hour of sensor
time. MODSLAM_SOAK_LOG: another log than the simulated demo; MODSLAM_SOAK_PASSES, MODSLAM_SOAK_HOURS, MODSLAM_SOAK_SPEED;
MODSLAM_SOAK_OUT keeps the run there; MODSLAM_SOAK_LOCALIZE: in the map of one way there and back, to which nothing is added.
"""
import math
import os
import pathlib
import statistics
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import check, equal, settings, succeed  # noqa: E402

PASSES = int(os.environ.get("MODSLAM_SOAK_PASSES", 10))
HOURS = float(os.environ.get("MODSLAM_SOAK_HOURS", 1))
SPEED = os.environ.get("MODSLAM_SOAK_SPEED", "100")
LONGEST_S = 3 * 3600  # of the clock on the wall
GROWTH = 0.01
INPUTS = ("LASER", "ODOMETRY", "INS", "SENSOR_INFO", "GROUND_TRUTH")
PAUSE_US = 100_000


def stamped(event, at_us):
    """The event as if it came at that time."""
    when, channel, data = event
    stamp = int.from_bytes(data[8:16], "big", signed=True) - when + at_us
    return at_us, channel, data[:8] + stamp.to_bytes(8, "big", signed=True) + data[16:]


def there_and_back(events, start_us):
    """Once to the end and back. The mount of the laser is told on the way there only."""
    first, last = events[0][0], events[-1][0]
    for event in events:
        yield stamped(event, start_us + event[0] - first)
    turn_us = start_us + last - first + PAUSE_US
    for event in reversed(events):
        if event[1] != "SENSOR_INFO":
            yield mirrored(event, turn_us + last - event[0])


def mirrored(event, at_us):
    """On the way back a stamp that lay before its event lies behind it."""
    when, channel, data = event
    stamp = at_us + when - int.from_bytes(data[8:16], "big", signed=True)
    return at_us, channel, data[:8] + stamp.to_bytes(8, "big", signed=True) + data[16:]


def many_times(log, seconds, path):
    """@return the times [us] at which each pass ends."""
    events = [event for event in system.events(log) if event[1] in INPUTS]
    once_us = 2 * (events[-1][0] - events[0][0]) + 2 * PAUSE_US
    laps, start_us = max(1, math.ceil(1e6 * seconds / once_us)), events[0][0]

    def whole():
        for lap in range(PASSES * laps):
            yield from there_and_back(events, start_us + lap * once_us)

    system.write_events(path, whole())
    return [start_us + (k + 1) * laps * once_us for k in range(PASSES)]


def in_each_pass(run_log, ends_us):
    """{process: [median of the kB in the second half of each pass]}: in the first half of the first one the map still grows, and a
    single word also tells how many messages happen to wait behind a fast player. What is said when the log has ended is of the finish: the
    estimator's polish needs its memory then, and no pass does."""
    found = {}
    pass_us, newest_us = ends_us[1] - ends_us[0], ends_us[-1] - 1_000_000
    for status in system.status_messages(run_log):
        if status["utime"] > newest_us:
            continue
        passed = sum(end_us < status["utime"] for end_us in ends_us)
        if passed < len(ends_us) and status["utime"] > ends_us[passed] - pass_us / 2:
            found.setdefault(status["name"], [[] for _ in ends_us])[passed].append(status["memory_kb"])
    return {name: [statistics.median(kb) for kb in row] for name, row in found.items() if all(row)}


def soak():
    source = os.environ.get("MODSLAM_SOAK_LOG")
    log = pathlib.Path(source) if source else system.simulated_log("drive.lcm")
    out = pathlib.Path(os.environ.get("MODSLAM_SOAK_OUT", system.FOLDER)).resolve()
    out.mkdir(parents=True, exist_ok=True)
    ends_us, words = many_times(log, 3600 * HOURS, system.FOLDER / "long.lcm"), []
    if os.environ.get("MODSLAM_SOAK_LOCALIZE"):
        words = ["--map", one_lap(log), "--localize-only"]
    print(succeed("replay", system.FOLDER / "long.lcm", "--speed", SPEED, "--out", out / "soak", *settings("viewer.port=0"), *words,
                  seconds=LONGEST_S), flush=True)
    summary = system.summary(out / "soak")
    equal(summary["scans_without_pose"], 0, "scans without a pose")
    rows, grown = in_each_pass(out / "soak" / "run.lcm", ends_us), {}
    print(f"{PASSES} passes, {summary['scans']} scans, {summary['graph']['nodes']} nodes; MB in each pass (median)")
    for name, row in sorted(rows.items()):
        grown[name] = row[-1] / row[0] - 1
        print(f"| {name} | {' | '.join(f'{kb / 1024:.1f}' for kb in row)} | {100 * grown[name]:+.2f} % |")
    all_growth = sum(row[-1] for row in rows.values()) / sum(row[0] for row in rows.values()) - 1
    print(f"all together {100 * all_growth:+.2f} %")
    check(max(grown.values()) < GROWTH, f"grown by more than {100 * GROWTH:.0f} % after the first pass: {grown}")


def one_lap(log):
    """A map to be localised in. @return its folder."""
    short, folder = system.FOLDER / "short.lcm", system.FOLDER / "map"
    events = [event for event in system.events(log) if event[1] in INPUTS]
    system.write_events(short, there_and_back(events, events[0][0]))
    succeed("replay", short, "--speed", SPEED, "--out", folder, *system.quick("launch.semantics=false"), seconds=LONGEST_S)
    return folder


if __name__ == "__main__":
    system.TESTS.clear()
    system.test("memory stays flat")(soak)
    system.main()
