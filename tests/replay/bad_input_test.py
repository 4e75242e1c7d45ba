#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Bad input: each gives words that name the place and a non-zero exit code or a counted skip; nothing ever crashes."""
import pathlib
import random
import re
import socket
import struct
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import BIN, check, equal, quick, run_sh, succeed, test  # noqa: E402

CRASH = re.compile(r"Traceback|Segmentation|Aborted|core dumped|terminate called|Sanitizer|unbound variable|line \d+: ")


def drive():
    return system.simulated_log("drive.lcm", "simulator.route=C_bedroom_full")


def broken(name, data):
    path = system.FOLDER / name
    path.write_bytes(data)
    return path


def answers(command, *expected, codes=(1,), env=None):
    """The command ends with one of these exit codes and says each of these words."""
    code, said = run_sh(*command, env=env, seconds=60)
    words = f"run.sh {' '.join(map(str, command))} ended with {code} and said:\n{said}"
    check(code in codes, f"{words}\nexpected one of {codes}")
    check(not CRASH.search(said), words)
    for word in expected:
        check(str(word) in said, f"{words}\nexpected in it: {word}")
    return said


def refused_everywhere(path, *expected):
    """offline and replay both refuse the log."""
    answers(["offline", path, "--out", system.FOLDER / "no", *quick()], *expected)
    answers(["replay", path, "--out", system.FOLDER / "no", *quick()], *expected)


@test("a file that is missing, empty, a folder or no log is refused by name")
def no_log():
    missing = system.FOLDER / "missing.lcm"
    refused_everywhere(missing, missing, "no such file")
    refused_everywhere(broken("empty.lcm", b""), "empty.lcm")
    refused_everywhere(broken("text.lcm", b"ODOM 0 0 0 0 0 0 1 host 1\n" * 50), "text.lcm", "LCM log")
    refused_everywhere(broken("noise.lcm", random.Random(3).randbytes(100_000)), "noise.lcm", "LCM log")
    answers(["offline", system.FOLDER, "--out", system.FOLDER / "no", *quick()], system.FOLDER)
    answers(["offline"], "which log")
    answers(["replay"], "which log")


@test("a log without a scan is refused by the name of the channel that it lacks")
def no_scan():
    path = system.write_events(system.FOLDER / "deaf.lcm", [e for e in system.events(drive()) if e[1] != "LASER"])
    refused_everywhere(path, path, "LASER")


def lose_in(log, scans_left_at_least):
    """offline and replay use what can be read, say where the damage is and end with 2."""
    folders = [system.FOLDER / (log.stem + verb) for verb in ("offline", "replay")]
    answers(["offline", log, "--out", folders[0], *quick()], log, "skipped", "at byte", codes=[2])
    answers(["replay", log, "--speed", 8, "--out", folders[1], *quick()], log, "skipped", "at byte", codes=[2])
    scans = [system.summary(folder)["scans"] for folder in folders]
    equal(scans[1], scans[0], "scans of the replay and offline")
    check(scans[0] >= scans_left_at_least, f"only {scans[0]} scans are left")


def short_drive(seconds):
    all_events = list(system.events(drive()))
    return [e for e in all_events if e[0] < all_events[0][0] + 1e6 * seconds]


@test("a log that was cut off gives all up to the cut, and its end is told")
def truncated():
    path = system.write_events(system.FOLDER / "cut.lcm", short_drive(60))
    scans = system.count(path, "LASER")
    path.write_bytes(path.read_bytes()[:-700])
    lose_in(path, scans - 2)


@test("a log with flipped and missing bytes in the middle gives all around them")
def garbled():
    path = system.write_events(system.FOLDER / "garbled.lcm", short_drive(60))
    scans = system.count(path, "LASER")
    data, dice = bytearray(path.read_bytes()), random.Random(7)
    for _ in range(30):
        data[len(data) // 2 + dice.randrange(20_000)] ^= 1 << dice.randrange(8)
    del data[len(data) // 3:len(data) // 3 + 5000]
    path.write_bytes(data)
    lose_in(path, scans - 60)


@test("NaN, infinite and negative ranges, wild lengths and torn messages in a log are counted; the run goes on")
def bad_values():
    spoiled, dice, bad = [], random.Random(11), 0
    for k, (utime, channel, data) in enumerate(short_drive(60)):
        data = bytearray(data)
        if channel == "LASER":
            beams = struct.unpack_from(">i", data, 16)[0]
            for beam in range(0, beams, 9):
                struct.pack_into(">f", data, 20 + 4 * beam, dice.choice([float("nan"), float("inf"), -float("inf"), -1.0, -1e30]))
        if channel == "ODOMETRY" and k % 40 == 0:
            struct.pack_into(">d", data, 16, float("nan"))
            bad += 1
        spoiled.append((utime, channel, bytes(data)))
        if k % 150 == 149:
            wild = bytearray(spoiled[-1][2])
            if channel == "LASER":
                struct.pack_into(">i", wild, 16, dice.choice([-1, 2**31 - 1, 1_000_000]))
            else:
                wild = wild[:len(wild) // 2]
            spoiled.append((utime, channel, bytes(wild)))
            bad += channel != "GROUND_TRUTH"
    path = system.write_events(system.FOLDER / "values.lcm", spoiled)
    folders = [system.FOLDER / "values_offline", system.FOLDER / "values_replay"]
    said = answers(["offline", path, "--out", folders[0], *quick()], "dropped a message on ODOMETRY", codes=[0, 2])
    print(said)
    answers(["replay", path, "--speed", 8, "--out", folders[1], *quick()], codes=[0, 2])
    for folder in folders:
        summary = system.summary(folder)
        check(summary["poses"] > 250, f"{folder}: {summary['poses']} poses")
        refused = sum(process["bad"] for process in summary["processes"].values())
        check(refused > 20, f"{folder}: of {bad} bad messages {refused} were counted")
        worst = summary["error"]["aligned_at_first_pose"]["position_m"]["max"]
        check(worst < 0.3, f"{folder}: the path is wrong by {worst} m")


@test("a CARMEN file with broken lines is imported without them, each is told by its number")
def carmen():
    lines = ["# a comment", "PARAM robot_frontlaser_offset 0.1"]
    for k in range(40):
        ranges = " ".join(f"{3 + 0.01 * beam:.2f}" for beam in range(180))
        lines.append(f"FLASER 180 {ranges} {0.1 * k:.2f} 0 0 {0.1 * k:.2f} 0 0 {k * 0.2:.3f} host {k * 0.2:.3f}")
    lines[10] = "FLASER 180 1.0 2.0"
    lines[20] = lines[20].replace("3.05", "three")
    lines[30] = "FLASER 99999999999 1 2 3"
    path, log = broken("broken.log", ("\n".join(lines) + "\n").encode()), system.FOLDER / "carmen.lcm"
    said = answers(["import", path, log], "3 entries skipped", "line 11", "line 21", "line 31", codes=[0])
    equal(system.count(log, "LASER"), 37, f"scans imported; it said {said}")
    answers(["import", path, log, "--strict"], "line 11")
    answers(["import", broken("prose.log", b"once upon a time\n" * 20), log], "prose.log")
    answers(["import", system.FOLDER / "missing.log", log], "missing.log")
    answers(["import", broken("torn.rawlog", bytes(range(256)) * 40), log], "torn.rawlog")
    answers(["import", broken("torn.log.gz", b"\x1f\x8b\x08" + bytes(200)), log], "torn.log.gz")
    answers(["import", path, "/proc/no/such/place.lcm"], "/proc/no/such/place.lcm")


@test("a wrong configuration is refused with file, line, value and bound")
def configuration():
    out = ["--out", system.FOLDER / "no"]
    for text, *expected in [("[laser]\nrate_hz = 5\nspeling = 3\n", "laser.toml:3", "speling"),
                            ("[laser]\nrate_hz = 'fast'\n", "laser.toml:2", "rate_hz"),
                            ("[laser]\nrate_hz = 5000\n", "laser.toml:2", "5000", "50"),
                            ("[lasers]\nrate_hz = 5\n", "laser.toml:1", "lasers"),
                            ("[laser\n", "laser.toml:1")]:
        path = broken("laser.toml", text.encode())
        answers(["demo", "--config", path, *out], *expected)
        answers(["offline", drive(), "--config", path, *out], *expected)
    for setting, *expected in [("laser.speling=3", "speling"), ("lasers.rate_hz=3", "lasers"), ("laser.rate_hz=fast", "rate_hz"),
                               ("laser.rate_hz=-1", "rate_hz", "-1"), ("laser.rate_hz=nan", "rate_hz"), ("laser", "laser"),
                               ("laser.model=camera", "camera", "sick")]:
        answers(["demo", "--set", setting, *out], *expected)
    answers(["demo", "--config", system.FOLDER / "none.toml", *out], "none.toml")
    answers(["simulate", system.FOLDER / "x.lcm", *quick("simulator.route=nowhere")], "nowhere")
    answers(["simulate", system.FOLDER / "x.lcm", *quick("simulator.world=no.geojson")], "no.geojson")
    answers(["replay", drive(), "--speed", "0", *out], "--speed 0")
    answers(["replay", drive(), "--speed", "fast", *out], "--speed fast")
    answers(["replay", drive(), "--drive", "--speed", "50", *out], "player.speed", "[0.1, 20.0]")
    answers(["demo", "--frobnicate"], "--frobnicate")
    answers(["frobnicate"], "frobnicate", codes=[2])
    answers(["demo", "--out", "/proc/nothing", *quick()], "/proc/nothing")
    answers(["report", system.FOLDER / "nothing"], "nothing")


@test("a route that does not exist ends the demo with words, not with waiting")
def missing_route():
    answers(["demo", "--out", system.FOLDER / "lost", *quick("simulator.route=nowhere")], "simulator", "nowhere")


@test("a port of the bus that is in use is refused; a page port that is in use is stepped over")
def ports():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as bus, socket.socket(socket.AF_INET, socket.SOCK_STREAM) as page:
        bus.bind(("", 0))
        port = str(bus.getsockname()[1])
        answers(["replay", drive(), "--out", system.FOLDER / "no", *quick()], port, "in use", env={"MODSLAM_PORT": port})
        page.bind(("127.0.0.1", 0))
        page.listen()
        taken = page.getsockname()[1]
        viewer = subprocess.run([BIN / "modslam-viewer", "--set", f"viewer.port={taken}", "--config", broken("empty.toml", b""), "--url",
                                 f"udpm://239.255.76.67:{system.free_port()}?ttl=0"],
                                capture_output=True, text=True, timeout=20, check=False)
        check(viewer.returncode == 1 and str(taken) in viewer.stderr, f"the viewer said {viewer.stderr}")
        said = succeed("replay", drive(), "--speed", 40, "--out", system.FOLDER / "page", *system.settings(f"viewer.port={taken}"))
        shown = re.search(r"http://127.0.0.1:(\d+)/", said)
        check(shown and int(shown[1]) > taken, f"the page is not beside the taken port {taken}:\n{said}")


if __name__ == "__main__":
    system.main()
