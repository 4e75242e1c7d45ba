#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""chaos_test.py BUILD_DIR [WORD...]: kill -9 of one process after another during a replay; nothing may be lost.

The long version: MODSLAM_CHAOS_KILLS=50 MODSLAM_CHAOS_PAUSE_S=2 tests/replay/chaos_test.py BUILD_DIR. MODSLAM_CHAOS_OUT keeps the results there.
"""
import json
import math
import os
import pathlib
import random
import signal
import struct
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import Run, check, equal, settings, succeed, test  # noqa: E402

KILLS = int(os.environ.get("MODSLAM_CHAOS_KILLS", 10))
PAUSE_S = float(os.environ.get("MODSLAM_CHAOS_PAUSE_S", 2))
SEED = int(os.environ.get("MODSLAM_CHAOS_SEED", 1))
ROUTE = "simulator.route=" + os.environ.get("MODSLAM_CHAOS_ROUTE", "C_bedroom_full")
POSES_APART_M, BACK_WITHIN_S = 0.010, 2.0
MARGINAL_M2 = 20.0
SENSORS = ["simulator", "laser", "odometry", "ins"]
LONGEST_STEP_M = 0.5  # of what odometry says from one message to the next: what the robot drives while a process comes back
VICTIMS = ["recorder", "scan_matcher", "graph_optimizer", "loop_detector", "map_builder", "semantic_classifier", "viewer"]


def program(name):
    return "modslam-" + name.replace("_", "-")


def nodes(folder):
    """Pose of each node by id."""
    rows = [line.split() for line in (folder / "graph.g2o").read_text().splitlines()]
    return {int(row[1]): tuple(map(float, row[2:5])) for row in rows if row[0] == "VERTEX_SE2"}


def features(folder, kind):
    found = json.loads((folder / "semantic.geojson").read_text())["features"]
    return [f for f in found if f["properties"]["kind"] == kind]


def pid_of(run, name):
    return dict(map(reversed, run.processes())).get(program(name))


def kill(run, name):
    """@return when, and the pid that it had."""
    pid = run.until(lambda: pid_of(run, name), 5, f"{name} runs")
    os.kill(pid, signal.SIGKILL)
    return name, pid, time.time()


def back_after_s(killed, said):
    """Seconds until the next life of a process spoke; `said` are the STATUS of the run."""
    name, pid, when = killed
    return min((at for at, speaker, spoken in said if speaker == name and spoken != pid and at > when), default=math.inf) - when


@test(f"{KILLS} processes are killed during a replay, each is back within {BACK_WITHIN_S:.0f} s, no node is lost and the maps are as without")
def chaos():
    log = system.simulated_log("drive.lcm", ROUTE)
    sensor_s = system.duration_s(log)
    out = pathlib.Path(os.environ.get("MODSLAM_CHAOS_OUT", system.FOLDER))
    calm, wild = out / "calm", out / "wild"
    succeed("offline", log, "--out", calm, *settings())
    speed = max(1.0, sensor_s / (KILLS * PAUSE_S + 4))
    order = random.Random(SEED)
    victims = [name for _ in range(KILLS // len(VICTIMS) + 1) for name in order.sample(VICTIMS, len(VICTIMS))][:KILLS]
    killed = []
    with Run("replay", log, "--speed", f"{speed:.2f}", "--out", wild, *settings("viewer.port=0")) as run:
        run.until(lambda: "Replaying" in run.said(), 60, "the replay starts")
        time.sleep(1.5)
        for name in victims:
            killed.append(kill(run, name))
            time.sleep(PAUSE_S)
        code, said = run.wait(300), run.said()
        run.leaves_nothing()
    equal(code, 0, f"{said}\nexit code")
    said_status, took = list(system.statuses(wild / "run.lcm")), {}
    for one in killed:
        took.setdefault(one[0], []).append(back_after_s(one, said_status))
    print(f"speed {speed:.1f}; seconds until it spoke again, at most: " +
          ", ".join(f"{name} {max(times):.2f}" for name, times in sorted(took.items())))
    check(max(max(times) for times in took.values()) < BACK_WITHIN_S, f"not back within {BACK_WITHIN_S} s: {took}")
    compare(calm, wild)


def steps_m(log, channel):
    """How far a pose of this channel is from the one before."""
    places = [struct.unpack_from(">dd", data, 16) for _, name, data in system.events(log) if name == channel]
    return [math.dist(a, b) for a, b in zip(places, places[1:])]


@test("the simulated world and its sensors are killed during a drive: each goes on where it was, and the drive ends as well as any")
def sensors():
    folder, order = system.FOLDER / "drive", random.Random(SEED)
    victims = [name for _ in range(2) for name in order.sample(SENSORS, len(SENSORS))]
    with Run("demo", "--out", folder, *system.quick(ROUTE, "simulator.speed=4", "launch.semantics=false", "ins.driver=simulated")) as run:
        run.until_driving()
        time.sleep(4)
        for name in victims:
            kill(run, name)
            time.sleep(1.2)
        code, said = run.wait(150), run.said()
    equal(code, 0, f"{said}\nexit code")
    longest = {channel: max(steps_m(folder / "run.lcm", channel)) for channel in ("GROUND_TRUTH", "ODOMETRY")}
    summary = system.summary(folder)
    error_m = summary["error"]["aligned_by_least_squares"]["position_m"]["mean"]
    print(f"longest steps [m] {longest}, scans {summary['scans']}, {summary['scans_without_pose']} without a pose, path error {1e3 * error_m:.1f} mm")
    check(max(longest.values()) < LONGEST_STEP_M, f"a sensor began anew: longest steps [m] {longest}")
    equal(summary["scans_without_pose"], 0, "scans without a pose")
    check(error_m < 0.05, f"the path errs by {error_m} m")


def compare(calm, wild):
    before, after = nodes(calm), nodes(wild)
    equal(sorted(after), list(range(len(after))), "ids of the nodes")
    equal(len(after), len(before), "nodes")
    apart = max(math.dist(before[k][:2], after[k][:2]) for k in before)
    one, other = system.summary(calm), system.summary(wild)
    loops = one["graph"]["loop_edges"], other["graph"]["loop_edges"]
    print(f"nodes {len(after)}, apart at most {1e3 * apart:.2f} mm, loop edges {loops}, scans {one['scans']} {other['scans']}, "
          f"without a pose {other['scans_without_pose']}")
    check(apart <= POSES_APART_M, f"nodes are apart {apart} m")
    # A region that was only glimpsed through its door may count as a room or not by a millimetre: at most one may fall otherwise.
    rooms, doors = ([len(features(folder, kind)) for folder in (calm, wild)] for kind in ("room", "door"))
    print(f"rooms {rooms}, doors {doors}")
    check(abs(rooms[0] - rooms[1]) <= 1 and abs(doors[0] - doors[1]) <= 1, f"rooms {rooms}, doors {doors}")
    areas = [[f["properties"]["area_m2"] for f in features(folder, "room")] for folder in (calm, wild)]
    alone = [a for a in areas[0] if not any(abs(a - b) < 0.1 * max(a, 1) for b in areas[1])]
    check(len(alone) <= 1 and all(a < MARGINAL_M2 for a in alone), f"rooms {alone} m2 have no partner among {areas[1]}")


if __name__ == "__main__":
    system.main()
