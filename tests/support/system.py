# SPDX-License-Identifier: BSD-3-Clause
"""For tests of the whole system: run.sh with a state of its own, LCM logs as bytes, and what is left over afterwards.

A test is a function with the decorator @test("the sentence that it proves"); main() runs them all and prints one line each, in the
way that tests/run_all.py reads.
"""
import contextlib
import json
import os
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import traceback

HOUSE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else os.environ.get("MODSLAM_BUILD", HOUSE / "build")).resolve()
SHARED = pathlib.Path(os.environ.get("MODSLAM_SHARED", HOUSE.parent / "shared"))
BIN = BUILD / "bin"
RESULTS = ["graph.g2o", "map.png", "map.yaml", "path.tum", "path_laser.tum", "report.html", "run.lcm", "semantic.geojson",
           "summary.json"]
TESTS = []
LARGEST_KEPT = 100 << 20  # bytes of a file of a script that failed
FOLDER = None  # of this script's files; main() makes it


class Skip(Exception):
    """The test cannot run here."""


def test(sentence):
    def register(function):
        TESTS.append((sentence, function))
        return function
    return register


def check(holds, words):
    if not holds:
        raise AssertionError(words)


def equal(found, expected, words):
    check(found == expected, f"{words}: {found!r}, expected {expected!r}")


def main():
    global FOLDER
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that finally and with clean up
    chosen = [(s, f) for s, f in TESTS if not sys.argv[2:] or any(word in s for word in sys.argv[2:])]
    failed = False
    with tempfile.TemporaryDirectory(prefix="modslam-test-") as folder:
        FOLDER = pathlib.Path(folder)
        for sentence, function in chosen:
            try:
                function()
                print("ok", sentence, flush=True)
            except Skip as why:
                print(f"skip {sentence} ({why})", flush=True)
            except Exception:  # pylint: disable=broad-except
                failed = True
                traceback.print_exc(file=sys.stdout)
                print("FAIL", sentence, flush=True)
        if failed:
            keep_products()
    sys.exit(1 if failed else 0)


def keep_products():
    """What a failed script made (logs of its runs, graphs, what processes said), for whoever looks for the cause; until it fails again."""
    kept = HOUSE / "logs" / "failed" / pathlib.Path(sys.argv[0]).stem
    shutil.rmtree(kept, ignore_errors=True)
    def left_out(folder, names):
        paths = [pathlib.Path(folder, name) for name in names]
        return [path.name for path in paths if not path.is_dir() and not (path.is_file() and path.stat().st_size <= LARGEST_KEPT)]

    try:
        shutil.copytree(FOLDER, kept, ignore=left_out)
        print(f"its files are kept in {kept}", flush=True)
    except (OSError, shutil.Error) as error:
        print(f"its files could not be kept: {error}", flush=True)


# --- run.sh ---

class Run:
    """A run.sh that goes on. Nothing of it survives the with block."""

    def __init__(self, *words, env=None):
        self.state = tempfile.mkdtemp(dir=FOLDER)
        self.env = {**os.environ, "MODSLAM_BUILD": str(BUILD), "MODSLAM_CURRENT": f"{self.state}/current",
                    "TMPDIR": self.state, **(env or {})}
        self.output = open(f"{self.state}/output", "w+", encoding="utf-8", errors="replace")
        # run.sh is the leader of a process group, as it is when a person types it.
        self.process = subprocess.Popen([HOUSE / "run.sh", *map(str, words)], stdout=self.output, stderr=subprocess.STDOUT,
                                        stdin=subprocess.DEVNULL, env=self.env, start_new_session=True, text=True,
                                        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.interrupt(signal.SIGTERM)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(20)
        for pid, _ in self.processes():
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        self.output.close()

    def interrupt(self, signal_number=signal.SIGINT):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal_number)

    def wait(self, seconds=150):
        """@return the exit code."""
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"run.sh still runs after {seconds} s:\n{self.said()}") from None

    def said(self):
        self.output.flush()
        return pathlib.Path(self.output.name).read_text(encoding="utf-8", errors="replace")

    def current(self):
        """What run.sh noted about the run: OUT, PORT, SUPERVISOR_PID ..."""
        path = pathlib.Path(self.env["MODSLAM_CURRENT"])
        lines = path.read_text().splitlines() if path.exists() else []
        return dict(line.split("=", 1) for line in lines)

    def processes(self):
        """pid and program of every process that was started with this run's state in its environment."""
        mark, found = f"MODSLAM_CURRENT={self.env['MODSLAM_CURRENT']}\0".encode(), []
        for entry in pathlib.Path("/proc").iterdir():
            if not entry.name.isdigit():
                continue
            with contextlib.suppress(OSError):
                words = (entry / "cmdline").read_bytes().split(b"\0")
                if mark in (entry / "environ").read_bytes() and words != [b""]:
                    found.append((int(entry.name), os.path.basename(words[0].decode(errors="replace"))))
        return found

    def until(self, holds, seconds, words):
        """@return what `holds` returned when it was true."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = holds()
            if value:
                return value
            check(self.process.poll() is None, f"{words}: run.sh ended with {self.process.returncode}:\n{self.said()}")
            time.sleep(0.05)
        raise AssertionError(f"{words}: not within {seconds} s:\n{self.said()}")

    def until_driving(self):
        return self.until(lambda: "Stop: Ctrl-C" in self.said(), 60, "the run starts")

    def leaves_nothing(self):
        """No process, no socket folder, no port, no note."""
        equal(self.processes(), [], "processes left over")
        equal([name for name in os.listdir(self.state) if name != "output"], [], "files left over")


def run_sh(*words, env=None, seconds=150):
    """@return exit code and output."""
    with Run(*words, env=env) as run:
        return run.wait(seconds), run.said()


def succeed(*words, **options):
    code, said = run_sh(*words, **options)
    equal(code, 0, f"run.sh {' '.join(map(str, words))} said:\n{said}\nexit code")
    return said


def settings(*all_settings):
    """As words for run.sh; MODSLAM_TEST_SETTINGS adds to them, for trying out another configuration."""
    words = []
    for setting in (*all_settings, *os.environ.get("MODSLAM_TEST_SETTINGS", "").split()):
        words += ["--set", setting]
    return words


def quick(*more):
    """Settings of a run that nobody looks at."""
    return settings("launch.viewer=false", *more)


def simulated_log(name, *settings):
    path = FOLDER / name
    if not path.exists():
        succeed("simulate", path, *quick(*settings))
    return path


def summary(folder):
    return json.loads((pathlib.Path(folder) / "summary.json").read_text())


def free_port(kind=socket.SOCK_DGRAM):
    with socket.socket(socket.AF_INET, kind) as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def poses(path):
    """Time [s], x, y [m], heading [rad] of a TUM file."""
    import math
    rows = [[float(word) for word in line.split()] for line in pathlib.Path(path).read_text().splitlines() if line[:1] != "#"]
    return [(t, x, y, 2 * math.atan2(qz, qw)) for t, x, y, _, _, _, qz, qw in rows]


# --- LCM logs as bytes ---

HEAD = struct.Struct(">Iqqii")
MAGIC = 0xEDA1DA01


def events(path):
    """utime, channel, bytes of a whole LCM log."""
    data = pathlib.Path(path).read_bytes()
    at = 0
    while at < len(data):
        magic, _, utime, channel_size, size = HEAD.unpack_from(data, at)
        assert magic == MAGIC, f"{path}: no event at byte {at}"
        at += HEAD.size
        yield utime, data[at:at + channel_size].decode(), data[at + channel_size:at + channel_size + size]
        at += channel_size + size


def write_events(path, all_events):
    with open(path, "wb") as out:
        for number, (utime, channel, data) in enumerate(all_events):
            out.write(HEAD.pack(MAGIC, number, utime, len(channel), len(data)) + channel.encode() + data)
    return path


class Fields:
    """Reads a message's fields one after the other."""

    def __init__(self, data):
        self.data, self.at = data, 8  # behind the type's fingerprint

    def number(self, kind):
        value, = struct.unpack_from(">" + kind, self.data, self.at)
        self.at += struct.calcsize(">" + kind)
        return value

    def text(self):
        size = self.number("i")
        self.at += size
        return self.data[self.at - size:self.at - 1].decode()


def status_messages(path):
    """Each STATUS in a run's log as a dictionary. inputs and outputs: {channel: (received, bad, lost)}."""
    for wall_us, channel, data in events(path):
        if channel != "STATUS":
            continue
        fields = Fields(data)
        status = {"wall_s": 1e-6 * wall_us, "utime": fields.number("q"), "name": fields.text(), "version": fields.text(),
                  "pid": fields.number("i"), "state": fields.number("b")}
        for way in ("inputs", "outputs"):
            status[way] = {fields.text(): tuple(fields.number("q") for _ in range(3)) for _ in range(fields.number("i"))}
        status["latency_us"] = fields.number("q"), fields.number("q")
        status["memory_kb"] = fields.number("q")
        yield status


def statuses(path):
    """Wall time [s], process and pid of each STATUS in a run's log."""
    for status in status_messages(path):
        yield status["wall_s"], status["name"], status["pid"]


def status_inputs(path):
    """Wall time [s], process and {channel: (received, bad, lost)} of each STATUS in a run's log."""
    for status in status_messages(path):
        yield status["wall_s"], status["name"], status["inputs"]


def duration_s(path):
    """Sensor time of a log."""
    times = [utime for utime, _, _ in events(path)]
    return 1e-6 * (max(times) - min(times))


def count(path, channel):
    return sum(1 for _, name, _ in events(path) if name == channel)
