#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A disk that is full, and a folder that cannot be written: words, an exit code, and what was there before stays whole."""
import contextlib
import os
import pathlib
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import BIN, HOUSE, Run, Skip, check, equal, quick, test  # noqa: E402

ROUTE = "simulator.route=C_bedroom_full"


@contextlib.contextmanager
def mounted(name, options):
    """An empty file system of its own in a folder."""
    folder = system.FOLDER / name
    folder.mkdir()
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], capture_output=True, text=True, check=False)
    if made.returncode != 0:
        raise Skip(f"no file system can be mounted here: {made.stderr.strip()}")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", folder], check=False)


@contextlib.contextmanager
def small_disk(name):
    """Room for one megabyte, and an old result in it."""
    with mounted(name, "size=1m") as folder:
        (folder / "map.png").write_text("old")
        yield folder


def old_is_whole(folder):
    equal((folder / "map.png").read_text(), "old", "the old result")
    equal([p.name for p in folder.iterdir() if p.name.endswith(".part")], [], "half files")


@test("offline on a disk that fills up says so, fails, and leaves the old results as they were")
def offline():
    with small_disk("offline") as folder:
        done = subprocess.run([BIN / "modslam-offline", system.simulated_log("drive.lcm", ROUTE), "--out", folder], cwd=HOUSE,
                              capture_output=True, text=True, check=False)
        equal(done.returncode, 1, f"{done.stderr}\nexit code")
        check("No space left on device" in done.stderr and str(folder) in done.stderr, f"it says: {done.stderr}")
        old_is_whole(folder)


@test("a replay onto a disk that fills up goes on to its end, says who could not write, fails, and leaves the old results as they were")
def replay():
    with small_disk("replay") as folder:
        with Run("replay", system.simulated_log("drive.lcm", ROUTE), "--speed", 30, "--out", folder, *quick()) as run:
            code, said = run.wait(100), run.said()
            run.leaves_nothing()
        equal(code, 1, f"{said}\nexit code")
        check("recorder cannot finish: recording has ended" in said and "No space left on device" in said, f"it says:\n{said}")
        old_is_whole(folder)


@test("a folder that cannot be written is refused before anything starts")
def read_only():
    with mounted("locked", "ro") as folder:
        code, said = system.run_sh("replay", system.simulated_log("drive.lcm", ROUTE), "--out", folder)
        check(code == 1 and "cannot be written" in said, f"exit code {code}, it says:\n{said}")


if __name__ == "__main__":
    if not os.environ.get("MODSLAM_OWN_MOUNTS") and subprocess.run(["unshare", "-rm", "true"], capture_output=True, check=False).returncode == 0:
        os.environ["MODSLAM_OWN_MOUNTS"] = "yes"
        os.execvp("unshare", ["unshare", "-rm", sys.executable, *sys.argv])
    system.main()
