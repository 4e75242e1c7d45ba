#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""peers.py BIN RUN: MRPT's rbpf-slam and icp-slam on the scans and the odometry of a run; their paths into RUN/peers/NAME.tum.

The report of the run then draws them beside ours. A peer that crashes is named and left out.
"""
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

CONFIGS = pathlib.Path("/usr/share/mrpt/config_files")
PEERS = {
    "rbpf-slam": ("rbpf-slam", CONFIGS / "rbpf-slam/gridmapping_RBPF_ICPbased_intel.ini"),
    "icp-slam": ("icp-slam", CONFIGS / "icp-slam/icp-slam_demo_classic.ini"),
}
QUIET = {"SHOW_PROGRESS_IN_WINDOW": 0, "SHOW_PROGRESS_3D_REAL_TIME": 0, "LOG_FREQUENCY": 1000000, "SAVE_3D_SCENE": 0, "SAVE_POSE_LOG": 0,
         "SAVE_MAP_IMAGES": 0}


def run(command, **options):
    """@return seconds of CPU and peak memory in MB of a command that must end well."""
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, **options)
    words = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))}: exit {process.returncode}: {words.decode(errors='replace').strip()[-400:]}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def run_peer(name, rawlog, folder):
    """Runs a peer with the parameters that MRPT ships for it. @return its poses of the robot (x y heading, one a scan), CPU seconds, MB."""
    program, parameters = PEERS[name]
    folder.mkdir()
    ini = parameters.read_text()
    for key, value in {**QUIET, "logOutput_dir": folder / "out"}.items():
        ini = re.sub(rf"(?m)^{key}\s*=.*$", f"{key}={value}", ini)
    (folder / "peer.ini").write_text(ini)
    cpu_s, memory_mb = run([program, folder / "peer.ini", rawlog], cwd=folder)
    lines = next(folder.glob("out/**/*estimated_path*.txt")).read_text().splitlines()
    rows = [list(map(float, line.split())) for line in lines if line.strip() and line[0] not in "%#"]
    return [row[-3:] if len(row) < 7 else (row[1], row[2], row[4]) for row in rows], cpu_s, memory_mb


def tum(poses, stamps_of, ahead_m=0.0):
    """Poses as TUM text, with the stamps of a path of ours (one line a scan); of the laser when it sits `ahead_m` before the robot's centre."""
    stamps = [line.split()[0] for line in stamps_of.read_text().splitlines()]
    return "".join(f"{stamp} {x + ahead_m * math.cos(heading):.6f} {y + ahead_m * math.sin(heading):.6f} 0 0 0 "
                   f"{math.sin(heading / 2):.9f} {math.cos(heading / 2):.9f}\n" for stamp, (x, y, heading) in zip(stamps, poses))


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    programs, folder = map(pathlib.Path, sys.argv[1:])
    (folder / "peers").mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as work:
        rawlog = pathlib.Path(work) / "log.rawlog"
        run([programs / "to_rawlog", folder / "run.lcm", rawlog])
        for name in PEERS:
            try:
                poses, cpu_s, memory_mb = run_peer(name, rawlog, pathlib.Path(work) / name)
            except (RuntimeError, OSError, StopIteration) as error:
                print(f"{name}: did not run: {str(error)[-200:]}")
                continue
            (folder / "peers" / f"{name}.tum").write_text(tum(poses, folder / "path.tum"))
            print(f"{name}: {len(poses)} poses, {cpu_s:.1f} s of CPU, {memory_mb:.0f} MB")


if __name__ == "__main__":
    main()
