#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A drive in two parts: the second run goes on with the graph of the first."""
import math
import pathlib
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import BIN, check, equal, quick, run_sh, succeed, test  # noqa: E402

ROUTE = "simulator.route=C_bedroom_full"
POSES_APART_M = 0.04  # the matcher's local map begins anew at the cut, odometry alone spans it, and the saved half was polished


def halves():
    events = list(system.events(system.simulated_log("drive.lcm", ROUTE)))
    cut = events[len(events) // 2][0]
    head = [event for event in events if event[1] == "SENSOR_INFO"][:1]
    return (system.write_events(system.FOLDER / "first.lcm", [e for e in events if e[0] < cut]),
            system.write_events(system.FOLDER / "second.lcm", head + [e for e in events if e[0] >= cut]))


def nodes(folder):
    rows = [line.split() for line in (folder / "graph.g2o").read_text().splitlines()]
    return [tuple(map(float, row[2:4])) for row in rows if row[0] == "VERTEX_SE2"]


def bytes_of(folder):
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@test("a replay with --map goes on with the saved graph, ends where one run of the whole log ends, and leaves the saved run as it was")
def goes_on():
    first_log, second_log = halves()
    whole, first, second = (system.FOLDER / name for name in ("whole", "first", "second"))
    succeed("offline", system.simulated_log("drive.lcm", ROUTE), "--out", whole, *quick())
    succeed("replay", first_log, "--speed", 30, "--out", first, *quick())
    saved = bytes_of(first)
    succeed("replay", second_log, "--speed", 30, "--out", second, "--map", first, *quick())
    check(bytes_of(first) == saved, "the saved run was changed")
    one, two, start = nodes(whole), nodes(second), nodes(first)
    check(abs(len(one) - len(two)) <= 2 and len(two) > len(start) + 50, f"nodes: whole {len(one)}, first part {len(start)}, with the second {len(two)}")
    apart = max(min(math.dist(a, b) for b in one) for a in two)
    end = math.dist(one[-1], two[-1])
    print(f"nodes {len(start)} + {len(two) - len(start)}, whole {len(one)}; farthest from a node of the whole {apart:.3f} m, ends {end:.3f} m apart")
    check(apart < 0.35, f"a node lies {apart} m from every node of the whole")
    path = {round(t, 3): (x, y) for t, x, y, _ in system.poses(whole / "path.tum")}
    off = [math.dist(path[round(t, 3)], (x, y)) for t, x, y, _ in system.poses(second / "path.tum") if round(t, 3) in path]
    check(len(off) > 300 and max(off) < POSES_APART_M, f"{len(off)} poses, at most {max(off)} m from the whole run's")


@test("--map with a folder that holds no run, or with the run's own folder, is refused in words")
def refused():
    log = system.simulated_log("drive.lcm", ROUTE)
    code, said = run_sh("replay", log, "--map", system.FOLDER, "--out", system.FOLDER / "none")
    check(code == 1 and "holds no journal" in said, f"exit code {code}, it says:\n{said}")


if __name__ == "__main__":
    system.main()
