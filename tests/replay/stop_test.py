#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A run that is cut short: Ctrl-C, run.sh stop, and processes that die."""
import os
import pathlib
import signal
import subprocess
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import BIN, Run, check, equal, quick, test  # noqa: E402

DEMO = quick("simulator.route=A_safe_loop", "simulator.speed=10")


def log_grows(folder, above=300_000):
    log = folder / "run.lcm"
    return log.exists() and log.stat().st_size > above


def readable(folder):
    """The log is whole but for its last event, and the results of the part that was driven are there."""
    report = subprocess.run([BIN / "modslam-report", folder], capture_output=True, text=True, check=False)
    check(report.returncode in (0, 2), f"modslam-report said: {report.stderr}")
    summary = system.summary(folder)
    check(summary["scans"] > 20 and summary["poses"] > 20, f"only {summary['scans']} scans and {summary['poses']} poses are in the log")


@test("Ctrl-C in the middle of a drive ends everything, keeps the log and exits with 130")
def interrupt():
    folder = system.FOLDER / "interrupted"
    with Run("demo", "--out", folder, *DEMO) as run:
        run.until(lambda: log_grows(folder), 60, "the log grows")
        run.interrupt()
        start = time.monotonic()
        equal(run.wait(30), 130, "exit code")
        check(time.monotonic() - start < 15, "it took long to stop")
        run.leaves_nothing()
        check("making what results" in run.said() and "path error" in run.said(), f"no results of the part driven:\n{run.said()}")
    readable(folder)


@test("Ctrl-C while the processes start leaves nothing behind either")
def interrupt_early():
    for pause_s in (0.3, 0.8, 1.3):
        with Run("demo", "--out", system.FOLDER / f"early{pause_s}", *DEMO) as run:
            time.sleep(pause_s)
            run.interrupt()
            equal(run.wait(30), 130, f"exit code after {pause_s} s:\n{run.said()}\n")
            run.leaves_nothing()


@test("Ctrl-C during a replay stops the player too")
def interrupt_replay():
    folder = system.FOLDER / "replay"
    with Run("replay", system.simulated_log("drive.lcm", "simulator.route=A_safe_loop"), "--speed", 5, "--out", folder, *quick()) as run:
        run.until(lambda: log_grows(folder), 60, "the log grows")
        check("lcm-logplayer" in [name for _, name in run.processes()], "no player was seen")
        run.interrupt()
        equal(run.wait(30), 130, "exit code")
        run.leaves_nothing()


@test("run.sh status shows each process, and run.sh stop from another shell ends the run with its results")
def stop():
    folder = system.FOLDER / "stopped"
    with Run("demo", "--out", folder, *DEMO) as run:
        run.until_driving()
        run.until(lambda: log_grows(folder), 60, "the log grows")
        other_shell = {**run.env, "TMPDIR": str(system.FOLDER)}
        status = subprocess.run([system.HOUSE / "run.sh", "status"], env=other_shell, capture_output=True, text=True, check=False)
        equal(status.returncode, 0, f"status said {status.stdout}{status.stderr}: exit code")
        for name in ("simulator", "laser", "odometry", "ins", "scan_matcher", "graph_optimizer", "loop_detector", "map_builder"):
            check(f"\n{name} " in status.stdout, f"status does not show {name}:\n{status.stdout}")
        stopped = subprocess.run([system.HOUSE / "run.sh", "stop"], env=other_shell, capture_output=True, text=True, check=False)
        equal(stopped.returncode, 0, f"stop said {stopped.stderr}: exit code")
        check(str(folder) in stopped.stdout, f"stop does not tell where the results are: {stopped.stdout}")
        equal(run.wait(20), 143, "exit code of the run")
        run.leaves_nothing()
    readable(folder)
    again = subprocess.run([system.HOUSE / "run.sh", "stop"], env=other_shell, capture_output=True, text=True, check=False)
    equal((again.returncode, again.stdout.strip()), (0, "no run is going on"), "a second stop")
    status = subprocess.run([system.HOUSE / "run.sh", "status"], env=other_shell, capture_output=True, text=True, check=False)
    equal((status.returncode, status.stderr.strip()), (1, "run.sh: no run is going on"), "status without a run")


@test("a process that is killed is started again, the run ends with results and says what happened")
def kill_one():
    folder = system.FOLDER / "killed"
    with Run("demo", "--out", folder, *DEMO) as run:
        for name in ("modslam-map-builder", "modslam-scan-matcher", "modslam-laser"):
            size = (folder / "run.lcm").stat().st_size if (folder / "run.lcm").exists() else 0
            run.until(lambda size=size: log_grows(folder, size + 300_000), 60, "the log grows")
            first = dict(map(reversed, run.processes()))[name]
            os.kill(first, signal.SIGKILL)
            run.until(lambda name=name, first=first: dict(map(reversed, run.processes())).get(name, first) != first, 10,
                      f"{name} is started again")
        code, said = run.wait(), run.said()
        run.leaves_nothing()
    equal(code, 0, f"{said}\nexit code")
    for name in ("map_builder", "scan_matcher", "laser"):
        check(f"{name} ended by itself" in said, f"nothing was said of {name}:\n{said}")
    summary = system.summary(folder)
    check(summary["poses"] > 700 and summary["map"]["tiles"] > 40, f"results are thin: {summary['poses']} poses, {summary['map']}")


if __name__ == "__main__":
    system.main()
