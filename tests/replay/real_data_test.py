#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Real recordings, where they are at hand: beside the source folder (or where MODSLAM_SHARED says), and in Debian's mrpt-common."""
import json
import pathlib
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import SHARED, Skip, check, equal, quick, run_sh, succeed, test  # noqa: E402

SENA = pathlib.Path("/usr/share/mrpt/datasets/2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog")


def imported(name, laser_x_m):
    """The recording as an LCM log; its laser's mount is known from the literature, not from the file."""
    source, log = SHARED / "data" / "slam" / name / f"{name}.clf.xz", system.FOLDER / f"{name}.lcm"
    if not source.exists():
        raise Skip(f"{source} is not here")
    if not log.exists():
        succeed("import", source, log, "--laser-x", laser_x_m)
    return log


def mean_relation_error_m(name, folder):
    data, scores = SHARED / "data" / "slam" / name, system.FOLDER / f"{name}.json"
    succeed("evaluate", "--relations", data / f"{name}.relations", "--times", data / f"{name}.times.csv.xz", "--path",
            folder / "path_laser.tum", "--json", scores)
    return json.loads(scores.read_text())["relations"]["all"]["translation_m"]["mean"]


def maps_well(name, laser_x_m, scans, largest_mean_m):
    log, folder = imported(name, laser_x_m), system.FOLDER / name
    print(succeed("offline", log, "--out", folder, *quick(), seconds=240))
    summary = system.summary(folder)
    equal((summary["scans"], summary["scans_without_pose"]), (scans, 0), "scans, and those without a pose")
    mean_m = mean_relation_error_m(name, folder)
    print(f"{name}: mean error of the relations {mean_m:.4f} m")
    check(mean_m <= largest_mean_m, f"mean error of the relations {mean_m} m, allowed {largest_mean_m} m")


@test("the Intel lab is mapped within 0.08 m of its relations")
def intel():
    maps_well("intel", 0.09, 13631, 0.08)


@test("Freiburg's building 079 is mapped within 0.06 m of its relations, though its odometry lies about the way back")
def fr079():
    maps_well("fr079", 0.08, 4934, 0.06)


def replayed(log, name):
    """Its first minute or so, at five times real time, without a lost scan."""
    folder, scans = system.FOLDER / (name + "_replayed"), system.count(log, "LASER")
    succeed("replay", log, "--speed", 5, "--out", folder, *quick())
    summary = system.summary(folder)
    equal((summary["scans"], summary["scans_without_pose"]), (scans, 0), "scans, and those without a pose")
    return summary


@test("two minutes of the Intel lab are replayed at 5 times real time without a lost scan")
def intel_replayed():
    all_events = system.events(imported("intel", 0.09))
    start, part = None, []
    for event in all_events:
        start = event[0] if start is None else start
        if event[0] > start + 120e6:
            break
        part.append(event)
    replayed(system.write_events(system.FOLDER / "intel_part.lcm", part), "intel")


@test("a drive around a faculty, from an MRPT rawlog, is imported, run offline and replayed without a lost scan")
def sena():
    if not SENA.exists():
        raise Skip("package mrpt-common is not installed")
    log, folder = system.FOLDER / "sena.lcm", system.FOLDER / "sena"
    check("225 scans of 361 beams" in succeed("import", SENA, log), "the importer does not tell 225 scans")
    succeed("offline", log, "--out", folder, *quick())
    still, live = system.summary(folder), replayed(log, "sena")
    equal((still["scans"], still["scans_without_pose"]), (225, 0), "scans offline, and those without a pose")
    equal(live["graph"]["nodes"], still["graph"]["nodes"], "nodes")


if __name__ == "__main__":
    system.main()
