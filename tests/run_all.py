#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""run_all.py BUILD_DIR [--verbose] [NAME...]: every suite of tests; the last line says `N passed, N failed`.

Says one line a suite, and all about what failed or was skipped; --verbose says a line for each test as it goes. A suite is modslam-tests (Catch2) or a script. A script says `ok SENTENCE`, `FAIL SENTENCE` or `skip SENTENCE` for each thing that
it tests, in its own words before that, and exits 0; with 77 it says that it cannot run here. NAMEs choose suites by part of the name.
"""
import atexit
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import xml.etree.ElementTree as ElementTree

TESTS = pathlib.Path(__file__).resolve().parent
SKIPPED = 77
SCRIPT_TIMEOUT_S = 300
CATCH_TIMEOUT_S = 600
MAX_WORDS = 6000  # of a failing test's output that are shown


class Tally:
    """Counts, and says what a person has to know."""

    def __init__(self, verbose):
        self.verbose = verbose
        self.passed, self.failed, self.skips = 0, [], []
        self.suite, self.suite_passed, self.suite_failed, self.suite_start = None, 0, 0, time.monotonic()
        self.since = time.monotonic()

    def enter(self, suite):
        """The tests that follow belong to `suite`; says how the one before went."""
        if suite == self.suite:
            return
        if self.suite and self.suite_passed + self.suite_failed:
            failed = f", {self.suite_failed} failed" if self.suite_failed else ""
            print(f"{time.monotonic() - self.suite_start:7.1f} s  {self.suite}: {self.suite_passed} passed{failed}", flush=True)
        self.suite, self.suite_passed, self.suite_failed, self.suite_start = suite, 0, 0, time.monotonic()

    def line(self, verdict, suite, name, seconds=None):
        self.enter(suite)
        now = time.monotonic()
        seconds = now - self.since if seconds is None else seconds
        self.since = now
        if self.verbose or verdict != "ok":
            print(f"{verdict:<8}{seconds:7.1f} s  {suite}: {name}", flush=True)

    def ok(self, suite, name, seconds=None):
        self.line("ok", suite, name, seconds)
        self.passed += 1
        self.suite_passed += 1

    def fail(self, suite, name, words, seconds=None):
        self.line("FAILED", suite, name, seconds)
        self.failed.append(f"{suite}: {name}")
        self.suite_failed += 1
        text = words.strip()
        if len(text) > MAX_WORDS:
            text = "[...]\n" + text[-MAX_WORDS:]
        print("".join(f"    | {line}\n" for line in text.splitlines()), end="", flush=True)

    def skip(self, suite, name):
        self.line("skipped", suite, name)
        self.skips.append(f"{suite}: {name}")

    def close(self):
        """@return the exit code."""
        self.enter(None)
        for name in self.failed:
            print("failed:", name)
        if self.skips:
            print(f"{len(self.skips)} skipped")
        print(f"{self.passed} passed, {len(self.failed)} failed", flush=True)
        return 1 if self.failed or not self.passed else 0


class Child:
    """A process with a process group of its own and a time limit. Only that group is ever ended."""

    latest = None

    def __init__(self, command, seconds, **options):
        self.timed_out = False
        self.process = subprocess.Popen(command, start_new_session=True, **options)
        self.timer = threading.Timer(seconds, self.time_out)
        self.timer.daemon = True
        self.timer.start()
        Child.latest = self

    def time_out(self):
        self.timed_out = True
        self.end()

    def end(self):
        """Asks first: scripts clean up behind themselves."""
        for signal_number, patience_s in ((signal.SIGTERM, 20), (signal.SIGKILL, 5)):
            try:
                os.killpg(self.process.pid, signal_number)
                self.process.wait(patience_s)
                return
            except ProcessLookupError:
                return
            except subprocess.TimeoutExpired:
                continue

    def wait(self):
        code = self.process.wait()
        self.timer.cancel()
        return code


def how_it_ended(child, code):
    if child.timed_out:
        return "took too long and was stopped"
    return f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended with exit code {code}"


# --- Catch2 ---

def complaint(element):
    """A failed assertion of Catch2's XML in words."""
    place = f"{element.get('filename')}:{element.get('line')}"
    words = " ".join((part.text or "").strip() for part in element.iter() if part.tag in ("Original", "Expanded", "Exception"))
    return f"{place}: {words or (element.text or '').strip()}"


def unit_suite(path):
    """unit/graph, process: the folder of a test's source below tests/."""
    folder = pathlib.Path(path).parent
    return f"unit/{folder.name}" if folder.parent.name == "unit" else folder.name or "unit"


def take_catch_case(tally, case):
    result = case.find("OverallResult")
    name, seconds = case.get("name"), float(result.get("durationInSeconds", 0))
    suite = unit_suite(case.get("filename", ""))
    warnings = [(w.text or "").strip() for w in case.iter("Warning")]
    skipped = [w for w in warnings if "skipped" in w]
    if result.get("success") != "true":
        failures = [complaint(e) for e in case.iter() if e.get("success") == "false" and e.tag == "Expression"]
        failures += [complaint(e) for e in case.iter() if e.tag in ("Failure", "Exception", "FatalErrorCondition")]
        infos = [(e.text or "").strip() for e in case.iter("Info")]
        tally.fail(suite, name, "\n".join(failures + infos), seconds)
    elif skipped:
        tally.skip(suite, f"{name} ({skipped[0]})")
    else:
        tally.ok(suite, name, seconds)


def run_catch(tally, build):
    program = build / "bin" / "modslam-tests"
    listed = subprocess.run([program, "--list-test-names-only"], capture_output=True, text=True, check=False).stdout.splitlines()
    report_in, report_out = os.pipe()
    with tempfile.TemporaryFile("w+") as words:
        child = Child([program, "-r", "xml", "-d", "yes", "-o", f"/dev/fd/{report_out}"], CATCH_TIMEOUT_S,
                      stdout=words, stderr=subprocess.STDOUT, pass_fds=[report_out], stdin=subprocess.DEVNULL, cwd=build)
        os.close(report_out)
        parser, cases = ElementTree.XMLPullParser(["end"]), 0
        with os.fdopen(report_in, encoding="utf-8", errors="replace") as report:
            for line in report:
                try:
                    parser.feed(line)
                    events = list(parser.read_events())
                except ElementTree.ParseError as error:
                    tally.fail("unit", "the report of modslam-tests", f"{error}: {line}")
                    break
                for _, element in events:
                    if element.tag == "TestCase":
                        cases += 1
                        take_catch_case(tally, element)
        code = child.wait()
        words.seek(0)
        said = words.read()
    if cases < len([name for name in listed if name.strip()]) or code < 0 or child.timed_out:
        tally.fail("unit", f"modslam-tests {how_it_ended(child, code)} after {cases} of {len(listed)} test cases", said)


# --- scripts ---

def run_script(tally, suite, command):
    child = Child(command, SCRIPT_TIMEOUT_S, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True,
                  errors="replace", env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1", "PYTHONUNBUFFERED": "1"})
    said, failed, counted = [], False, 0
    for line in child.process.stdout:
        found = re.match(r"(ok|FAIL|skip) +(.*)", line)
        if not found:
            said.append(line)
            continue
        verdict, name = found.groups()
        counted += 1
        if verdict == "ok":
            tally.ok(suite, name)
        elif verdict == "skip":
            tally.skip(suite, name)
        else:
            tally.fail(suite, name, "".join(said))
            failed = True
        said = []
    code = child.wait()
    if code == SKIPPED and not failed:
        tally.skip(suite, "".join(said).strip() or "says that it cannot run here")
    elif (code != 0 and not failed) or child.timed_out:
        tally.fail(suite, how_it_ended(child, code), "".join(said))
    elif code == 0 and not counted:
        tally.fail(suite, "tested nothing", "".join(said))


def suites(build):
    """Name and how to run it."""
    yield "unit", lambda tally: run_catch(tally, build)
    commands = {f"layers/{p.stem}": [sys.executable, p, build] for p in sorted(TESTS.glob("layers/*_test.py"))}
    commands["viewer"] = [sys.executable, TESTS / "viewer" / "viewer_test.py", build / "bin"]
    commands["viewer/replay_page"] = [sys.executable, TESTS / "viewer" / "replay_page_test.py", build]
    commands["spy"] = ["bash", TESTS / "spy" / "spy_test.sh", build]
    commands["spy/text"] = ["bash", TESTS / "spy" / "text_spy_test.sh", build]
    commands.update({f"replay/{p.stem}": [sys.executable, p, build] for p in sorted(TESTS.glob("replay/*_test.py"))})
    for name, command in commands.items():
        yield name, lambda tally, name=name, command=command: run_script(tally, name, command)


def main():
    if len(sys.argv) < 2 or not (pathlib.Path(sys.argv[1]) / "bin").is_dir():
        sys.exit("run_all.py BUILD_DIR [--verbose] [NAME...]: the first argument is a folder with a build in it")
    build, wanted = pathlib.Path(sys.argv[1]).resolve(), [word for word in sys.argv[2:] if word != "--verbose"]
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    atexit.register(lambda: Child.latest and Child.latest.process.poll() is None and Child.latest.end())
    tally, start = Tally("--verbose" in sys.argv), time.monotonic()
    for name, run in suites(build):
        if wanted and not any(part in name for part in wanted):
            continue
        tally.since = time.monotonic()
        run(tally)
    tally.enter(None)
    print(f"{time.monotonic() - start:7.1f} s  in all")
    sys.exit(tally.close())


if __name__ == "__main__":
    main()
