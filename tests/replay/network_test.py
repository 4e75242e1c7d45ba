#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Sensors on one machine, mapping on a second, a viewer and a second recorder on a third, on a network that loses packets.

network_test.py BUILD_DIR [WORD...]; the long version: MODSLAM_LOSSES="1 5 10" MODSLAM_NETWORK_SEEDS="1 2 3" and, for the demo's route in real time,
MODSLAM_NETWORK_ROUTE=demo MODSLAM_NETWORK_SPEED=1.
"""
import os
import pathlib
import subprocess
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import hosts  # noqa: E402
import system  # noqa: E402
from system import BIN, HOUSE, Skip, check, equal, test  # noqa: E402

LOSSES = [int(word) for word in os.environ.get("MODSLAM_LOSSES", "10").split()]
SEEDS = [int(word) for word in os.environ.get("MODSLAM_NETWORK_SEEDS", "1").split()]
ROUTE = os.environ.get("MODSLAM_NETWORK_ROUTE", "C_bedroom_full")
SPEED = float(os.environ.get("MODSLAM_NETWORK_SPEED", 6))
SENSORS, MAPPING = ["odometry", "laser", "ins"], ["scan_matcher", "graph_optimizer", "loop_detector", "map_builder"]
LATECOMERS = {"viewer": "desk", "semantic_classifier": "mapping"}  # and their machines
LATE_WITHIN_S, ERROR_SHARE = 2.0, 0.10
COUNT_SHARE = 0.01
SLACK_M = 0.001  # of a single drive; which loop is found first differs from run to run
COUNTED = ("LASER", "SENSOR_INFO", "ODOMETRY", "INS", "SIM_STATE", "GROUND_TRUTH", "SIM_INFO", "STATUS")
REPAIRED, LONGEST_GAP_S = ("LASER", "ODOMETRY", "INS"), 0.85  # the cable is cut for longer; what was asked for just before may stay lost
CUT_S = 1.3  # longer than anybody waits for an answer
PORT = 31250


def url(port):
    return f"udpm://239.255.76.67:{port}?ttl=1&recv_buf_size=4194304"


class Building:
    """One drive of the simulated robot over three machines."""

    def __init__(self, name, network, seed, port=PORT):
        self.sensors, self.mapping, self.desk = network
        self.url, self.seed = url(port), seed
        alike = len(list(system.FOLDER.glob(f"{name}-drive*")))  # with 0 among the losses a drive is made twice
        self.folder = system.FOLDER / f"{name}-drive{alike + 1}"
        self.folder.mkdir()
        self.settings = [f"simulator.route={ROUTE}", f"simulator.speed={SPEED}", "simulator.delay_s=4", "viewer.port=0", f"simulator.seed={seed}"]

    def start(self, host, process, *more):
        words = [BIN / f"modslam-{process.replace('_', '-')}", "--config", HOUSE / "config" / "modslam.toml"]
        for setting in (*self.settings, *more):
            words += ["--set", setting]
        return host.start(words, self.folder / f"{process}-{host.name}.log", {"LCM_DEFAULT_URL": self.url})

    def conduct(self, host, *words, seconds=60):
        return subprocess.run(host.inside([BIN / "modslam-conduct", "--url", self.url, "--timeout", seconds, *words]), check=False,
                              capture_output=True, text=True)

    def log(self, host):
        return self.folder / host.name / "run.lcm"

    def record(self, host):
        self.log(host).parent.mkdir()
        return self.start(host, "recorder", f"recorder.path={self.log(host)}")

    def drive(self, loss, disorder):
        self.recorder = self.record(self.mapping)
        for process in MAPPING:
            self.start(self.mapping, process)
        for process in SENSORS:
            self.start(self.sensors, process)
        up = self.conduct(self.mapping, "up", *MAPPING, *SENSORS, seconds=15)
        equal(up.returncode, 0, f"{up.stderr}: starting")
        self.record(self.desk)
        time.sleep(1.2)  # everybody has heard a STATUS of everybody
        self.start(self.sensors, "simulator")
        heard = self.conduct(self.mapping, "up", "simulator", seconds=15)  # listeners count what is lost from a sender's first STATUS on
        equal(heard.returncode, 0, f"{heard.stderr}: the simulator")
        time.sleep(1.5)
        for host in (self.sensors, self.mapping):
            host.wire.loss = loss / 100
            if disorder:
                host.wire.delay_s, host.wire.jitter_s, host.wire.doubled, host.wire.reordered = 0.005, 0.003, 0.01, 0.1
        self.joined_at = self.join_late()
        if loss:
            # Somebody steps on the cable, at the worst moment: all have just been told what they lack, and their questions get no answer.
            check(self.sensors.wire.cut_after_word_of(SENSORS[self.seed % len(SENSORS)]), "a sensor's process has not spoken")
            time.sleep(CUT_S)
            self.sensors.wire.loss = loss / 100
        ended = self.conduct(self.mapping, "ended", "simulator", seconds=100)
        equal(ended.returncode, 0, f"{ended.stderr}: the drive")
        time.sleep(2.5)  # the last counts are told
        settled = self.conduct(self.mapping, "settle", "scan_matcher", "graph_optimizer", "loop_detector", "graph_optimizer", "map_builder",
                               "semantic_classifier")
        equal(settled.returncode, 0, f"{settled.stderr}: settling")
        self.overrun = self.sensors.wire.overrun() + self.mapping.unread(self.recorder)  # that a busy machine dropped, in the switch or behind it
        self.dropped = {channel: self.sensors.wire.dropped[channel] for channel in COUNTED}
        time.sleep(4)  # what got lost of the last words is asked for and told

    def join_late(self):
        """Some processes are started in the middle. @return when."""
        time.sleep(8)
        for process, host in LATECOMERS.items():
            self.start(getattr(self, host), process)
        return time.time()

    def results(self, host):
        folder = self.log(host).parent
        made = subprocess.run([BIN / "modslam-report", folder], capture_output=True, text=True, check=False)
        check(made.returncode in (0, 2), f"{made.stderr}: report")
        return system.summary(folder)

    def longest_gap_s(self):
        """Of sensor time, in the record of the mapping machine, by channel."""
        times = {channel: [] for channel in REPAIRED}
        for _, channel, data in system.events(self.log(self.mapping)):
            if channel in times:
                times[channel].append(system.Fields(data).number("q"))
        return {channel: max(1e-6 * (b - a) for a, b in zip(sorted(all_us), sorted(all_us)[1:])) for channel, all_us in times.items()}

    def complete_after_s(self, process):
        """From its late start until it told of as many nodes as there were."""
        nodes, name = 0, process.encode() + b"\0"
        for utime, channel, data in system.events(self.log(self.mapping)):
            nodes += channel == "NODE" and int.from_bytes(data[16:24], "big") == nodes
            if channel == "STATUS" and name in data and b" nodes\0" in data:
                told = int(data.split(b" nodes\0")[0].split(b" ")[-1])
                if told >= nodes - 1 > 0:
                    return 1e-6 * utime - self.joined_at
        return float("inf")

    def lost_of_sensors(self):
        """As the recorder on the mapping machine counted, of what the sensors' machine sent, by channel."""
        newest = {}
        for status in system.status_messages(self.log(self.mapping)):
            if status["pid"] == self.recorder.pid:  # the desk's recorder is heard here too, and counts what two wires lose
                newest = status["inputs"]
        return {channel: newest[channel][2] if channel in newest else 0 for channel in COUNTED}


def drive(loss, seed, disorder=False):
    with hosts.Network("sensors", "mapping", "desk", seed=seed) as network:
        building = Building(f"loss{loss}-{seed}{'-disorder' if disorder else ''}", network, seed)
        building.drive(loss, disorder)
    return building


def error_m(summary):
    """Laid over the truth by least squares: the first pose, and with it the whole path, hangs on the first few scans."""
    return summary["error"]["aligned_by_least_squares"]["position_m"]["mean"]


def same_everywhere(here, there):
    for key in ("nodes", "edges", "loop_edges"):
        equal(there["graph"][key], here["graph"][key], f"{key} at the desk and at the mapping machine")
    equal(there["map"]["tiles"], here["map"]["tiles"], "tiles at the desk and at the mapping machine")


def own_network():
    if not os.environ.get("MODSLAM_OWN_NETWORK"):
        raise Skip("network namespaces are not allowed here")


def lossy_drive(loss, seed):
    """@return the error of the path."""
    wild = drive(loss, seed)
    here, there = wild.results(wild.mapping), wild.results(wild.desk)
    counted, late = wild.lost_of_sensors(), {process: wild.complete_after_s(process) for process in LATECOMERS}
    drops, lost = sum(wild.dropped.values()), sum(counted.values())
    otherwise = {channel: (drop, counted[channel]) for channel, drop in wild.dropped.items() if drop != counted[channel]}
    print(f"dropped and counted otherwise: {otherwise}", flush=True)
    print(f"loss {loss} %, seed {seed}: {drops} messages dropped, and {wild.overrun} by the busy machine, {lost} counted; path error {1e3 * error_m(here):.2f} mm; scans "
          f"{here['scans']}, {here['scans_without_pose']} without a pose; nodes {here['graph']['nodes']}, at the desk {there['graph']['nodes']}; "
          f"complete after a late start: {', '.join(f'{process} after {after_s:.1f} s' for process, after_s in late.items())}", flush=True)
    gaps_s = wild.longest_gap_s()
    print(f"longest gaps that stayed: {', '.join(f'{channel} {gap_s:.2f} s' for channel, gap_s in gaps_s.items())}", flush=True)
    same_everywhere(here, there)
    for channel, gap_s in gaps_s.items():
        check(gap_s < LONGEST_GAP_S, f"{gap_s} s of {channel} stayed lost")
    equal(here["scans_without_pose"], 0, "scans without a pose")
    check(abs(lost - drops) <= max(COUNT_SHARE * drops, 3) + wild.overrun, f"{drops} messages were dropped, {lost} counted, {wild.overrun} by the busy machine")
    for process, after_s in late.items():
        check(after_s < LATE_WITHIN_S, f"the {process} was complete after {after_s:.1f} s")
    return error_m(here)


@test(f"three machines on a network that loses {LOSSES} % and for {CUT_S} s all: nothing of that time stays lost, every machine has the whole graph and map in the end, and the path is as good as without")
def lossy():
    own_network()
    undisturbed = []
    for seed in SEEDS:
        calm = drive(0, seed)
        undisturbed.append(error_m(calm.results(calm.mapping)))
    mean = sum(undisturbed) / len(SEEDS)
    print(f"undisturbed: path error {1e3 * mean:.2f} mm ({', '.join(f'{1e3 * e:.2f}' for e in undisturbed)})", flush=True)
    for loss in LOSSES:
        error = sum(lossy_drive(loss, seed) for seed in SEEDS) / len(SEEDS)
        print(f"loss {loss} %: path error {1e3 * error:.2f} mm, {error / mean:.3f} of the undisturbed", flush=True)
        check(error <= (1 + ERROR_SHARE) * mean + SLACK_M / len(SEEDS), f"path error {error} m, undisturbed {mean} m")


@test("two robots on one network, each on its own port, hear nothing of each other")
def two_robots():
    own_network()
    with hosts.Network("one", "other", seed=SEEDS[0]) as network:
        robots = [Building(host.name, (host, host, host), seed, PORT + seed) for seed, host in enumerate(network)]
        for robot in robots:
            robot.record(robot.mapping)
            robot.pids = {robot.start(robot.sensors, process).pid for process in ("simulator", *SENSORS)}
        time.sleep(8)
        crossed = sum(sum(host.wire.sent.values()) for host in network)
    for robot in robots:
        heard = list(system.status_messages(robot.log(robot.mapping)))
        recorder = {status["pid"] for status in heard if status["name"] == "recorder"}
        check(len(recorder) == 1 and {status["pid"] for status in heard} - recorder == robot.pids, "a process of the other robot was heard")
        check(system.count(robot.log(robot.mapping), "LASER") > 50, "the robot's own laser was not heard")
    check(crossed > 1000, f"only {crossed} packets went over the network: this shows nothing")


@test("packets that come late, twice and in another order change nothing: every scan has its pose, every machine the whole graph and map")
def disordered():
    own_network()
    wild = drive(2, SEEDS[0], disorder=True)
    here, there = wild.results(wild.mapping), wild.results(wild.desk)
    print(f"path error {1e3 * error_m(here):.2f} mm, scans {here['scans']}, {here['scans_without_pose']} without a pose")
    same_everywhere(here, there)
    equal(here["scans_without_pose"], 0, "scans without a pose")


if __name__ == "__main__":
    hosts.in_own_network()
    system.main()
