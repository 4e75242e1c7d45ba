#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a fast player through the hub gives is what offline gives: also of logs whose stamps step back, as those of many real robots do."""
import math
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import SHARED, Skip, check, equal, quick, succeed, test  # noqa: E402

SPEED = 100
POSES_APART_M, POSES_APART_RAD = 0.005, 0.001
NO_ROOMS = "launch.semantics=false"  # this is about scans, poses and loops


def edges(folder):
    """Kind and nodes of each."""
    rows = [line.split() for line in (folder / "graph.g2o").read_text().splitlines()]
    return sorted((int(row[1]), int(row[2])) for row in rows if row[0].startswith("EDGE"))


def lost_by(folder):
    """What anybody says that it lacks, in its last word."""
    last = {}
    for _, process, inputs in system.status_inputs(folder / "run.lcm"):
        last[process] = {channel: counts[2] for channel, counts in inputs.items() if counts[2]}
    return {process: lost for process, lost in last.items() if lost}


def same_as_offline(log, name):
    """@return the folder of the replay and of the offline run."""
    still, fast = system.FOLDER / f"{name}_offline", system.FOLDER / f"{name}_replayed"
    succeed("offline", log, "--out", still, *quick(NO_ROOMS))
    succeed("replay", log, "--speed", SPEED, "--out", fast, *quick(NO_ROOMS), seconds=240)
    found, expected = system.summary(fast), system.summary(still)
    equal((found["scans"], found["scans_without_pose"]), (system.count(log, "LASER"), 0), "scans, and those without a pose")
    equal(lost_by(fast), {}, "messages that somebody lacks")
    equal(found["graph"]["nodes"], expected["graph"]["nodes"], "nodes")
    on_bus, in_program = system.poses(fast / "path.tum"), system.poses(still / "path.tum")
    equal(len(on_bus), len(in_program), "poses")
    apart_m = max(math.dist(a[1:3], b[1:3]) for a, b in zip(on_bus, in_program))
    apart_rad = max(abs(math.remainder(a[3] - b[3], 2 * math.pi)) for a, b in zip(on_bus, in_program))
    one_sided = set(edges(fast)) ^ set(edges(still))
    print(f"{name}: {found['scans']} scans, {found['graph']['loop_edges']} loop edges, poses apart at most {1e3 * apart_m:.3f} mm {apart_rad:.5f} rad")
    check(apart_m <= POSES_APART_M and apart_rad <= POSES_APART_RAD, f"poses are apart {apart_m} m, {apart_rad} rad")
    equal(sorted(one_sided), [], "edges that only one of the two has")
    return fast, still


def restamped(log, path):
    """The same drive by a clock that is set back now and then: every 25 s its stamps lag by 0.15 s for a while."""
    start, changed = None, []
    for at, channel, data in system.events(log):
        start = at if start is None else start
        stamp = int.from_bytes(data[8:16], "big", signed=True)
        if channel in ("LASER", "ODOMETRY") and (at - start) % 25_000_000 > 20_000_000:
            stamp -= 150_000
        changed.append((at, channel, data[:8] + stamp.to_bytes(8, "big", signed=True) + data[16:]))
    return system.write_events(path, changed)


def steps_back(log):
    """How often the stamp of a scan is not later than that of the one before."""
    stamps = [int.from_bytes(data[8:16], "big") for _, channel, data in system.events(log) if channel == "LASER"]
    return sum(b <= a for a, b in zip(stamps, stamps[1:]))


@test(f"a drive whose stamps step back gives at {SPEED} times real time the edges and poses that it gives offline, and nobody lacks a message")
def stepping_back():
    log = restamped(system.simulated_log("drive.lcm", "laser.rate_hz=10"), system.FOLDER / "stepping_back.lcm")
    check(steps_back(log) > 5, "the stamps do not step back")
    fast, _ = same_as_offline(log, "stepping_back")
    check(system.summary(fast)["graph"]["loop_edges"] > 10, "a drive without loops shows nothing")


@test(f"the Intel lab at {SPEED} times real time: not one scan lost, the edges and poses that it gives offline")
def intel():
    source, log = SHARED / "data" / "slam" / "intel" / "intel.clf.xz", system.FOLDER / "intel.lcm"
    if not source.exists():
        raise Skip(f"{source} is not here")
    succeed("import", source, log, "--laser-x", 0.09)
    same_as_offline(log, "intel")


if __name__ == "__main__":
    system.main()
