#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Who looks after the processes: a process that hangs is started again, status and doctor say what is going on."""
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import BIN, Run, check, equal, quick, run_sh, test  # noqa: E402

DEMO = quick("simulator.route=demo", "simulator.speed=4")
HANG_S = 5


def ask(run, verb):
    asked = subprocess.run([system.HOUSE / "run.sh", verb], env=run.env, capture_output=True, text=True, check=False)
    return asked.returncode, asked.stdout + asked.stderr


def pid_of(run, program):
    return dict(map(reversed, run.processes())).get(program)


def restarts(table, name):
    row = re.search(rf"^{name} +\w+ +\d+ +(\d+)", table, re.M)
    check(row, f"no row of {name} in\n{table}")
    return int(row.group(1))


@test("a process that hangs is ended and started again, status counts it, doctor names a silent laser, and the run goes on")
def hang():
    with Run("demo", "--out", system.FOLDER / "hang", *DEMO) as run:
        run.until_driving()
        run.until(lambda: (system.FOLDER / "hang" / "run.lcm").exists(), 20, "the log is there")
        time.sleep(3)
        code, said = ask(run, "doctor")
        equal(code, 0, f"doctor says of a healthy run:\n{said}\nexit code")
        code, table = ask(run, "status")
        equal(code, 0, f"status says of a healthy run:\n{table}\nexit code")
        equal(restarts(table, "map_builder"), 0, "restarts")
        builder, laser = pid_of(run, "modslam-map-builder"), pid_of(run, "modslam-laser")
        os.kill(laser, signal.SIGSTOP)
        code, said = ask(run, "doctor")
        os.kill(laser, signal.SIGCONT)
        check(code == 1 and re.search(r"laser.*(silent for|nothing came)", said), f"doctor says of a laser that hangs:\n{said}")
        os.kill(builder, signal.SIGSTOP)
        start = time.monotonic()
        run.until(lambda: pid_of(run, "modslam-map-builder") not in (None, builder), HANG_S + 5, "the map builder is started again")
        took = time.monotonic() - start
        check(HANG_S - 1.5 < took < HANG_S + 3, f"that took {took:.1f} s")
        time.sleep(1.5)
        code, table = ask(run, "status")
        equal((code, restarts(table, "map_builder")), (0, 1), f"exit code and restarts in\n{table}")
        print(f"a process that hung was replaced after {took:.1f} s")
        run.interrupt()
        run.wait(40)
        run.leaves_nothing()


@test("doctor looks at the machine when no run is going on, and says when it cannot work there")
def alone():
    code, said = run_sh("doctor")
    check(code == 0 and "No run is going on" in said, f"doctor says:\n{said}")
    lonely = subprocess.run(["unshare", "-rn", BIN / "modslam-doctor", "--no-run"], capture_output=True, text=True, check=False)
    if "unshare" in lonely.stderr:
        raise system.Skip("network namespaces are not allowed here")
    equal(lonely.returncode, 1, f"doctor without a network says:\n{lonely.stdout}{lonely.stderr}\nexit code")
    check("no multicast route" in lonely.stdout and "ip route add" in lonely.stdout, f"doctor without a network says:\n{lonely.stdout}")


if __name__ == "__main__":
    system.main()
