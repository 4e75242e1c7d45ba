#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A saved map is used, not changed: another drive through the same rooms, begun somewhere in the middle."""
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import check, equal, quick, run_sh, succeed, test  # noqa: E402

ROUTE = "simulator.route=C_bedroom_full"
PLACED_SHARE, ERROR_M = 0.8, 0.03


def second_half():
    """Of a drive with another noise: the robot wakes up where no map begins."""
    events = list(system.events(system.simulated_log("again.lcm", ROUTE, "simulator.seed=2")))
    cut = events[len(events) // 2][0]
    head = [event for event in events if event[1] == "SENSOR_INFO"][:1]
    return system.write_events(system.FOLDER / "half.lcm", head + [e for e in events if e[0] >= cut])


def bytes_of(folder):
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@test("a replay with --localize-only finds the robot in a saved map from nowhere, adds nothing to it and leaves the saved bytes as they were")
def localizes():
    saved, found = system.FOLDER / "saved", system.FOLDER / "found"
    succeed("replay", system.simulated_log("drive.lcm", ROUTE), "--speed", 30, "--out", saved, *quick("launch.semantics=false"))
    before = bytes_of(saved)
    log = second_half()
    succeed("replay", log, "--speed", 8, "--out", found, "--map", saved, "--localize-only", *quick())
    check(bytes_of(saved) == before, "the saved run was changed")
    one, other = system.summary(saved), system.summary(found)
    scans, poses = system.count(log, "LASER"), len(system.poses(found / "path.tum"))
    error = other["error"]["aligned_by_least_squares"]["position_m"]
    print(f"{poses} of {scans} scans placed, error mean {1e3 * error['mean']:.1f} mm, largest {1e3 * error['max']:.1f} mm")
    equal(other["graph"]["nodes"], one["graph"]["nodes"], "nodes")
    check(poses >= PLACED_SHARE * scans, f"{poses} of {scans} scans were placed")
    check(error["mean"] < ERROR_M, f"mean error {error['mean']} m")


@test("--localize-only without a map is refused in words")
def refused():
    code, said = run_sh("replay", system.simulated_log("drive.lcm", ROUTE), "--localize-only", "--out", system.FOLDER / "none")
    check(code == 1 and "in which map" in said, f"exit code {code}, it says:\n{said}")


if __name__ == "__main__":
    system.main()
