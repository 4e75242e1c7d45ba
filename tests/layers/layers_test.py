#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""layers_test.py BUILD_DIR: the tree keeps its rules, and docs/architecture.md says what the sources do."""
import os
import pathlib
import re
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import BIN, HOUSE, check, equal, test  # noqa: E402

LONGEST_FILE_LINES = 400
SOURCES = {".cpp", ".hpp", ".py", ".sh", ".js", ".css", ".html", ".lcm", ".cmake"}
FOLDERS = ("common", "procs", "viewer", "lcmtypes")
# Helpers of common/bus that speak for the module that owns one, by the class's name.
HELPERS = {"GraphMirror": "graph_mirror", "ScanSource": "scan_source", "EstimatorSession": "estimator_session",
           "SimulationStates": "simulation_messages"}
EVERYBODY_IN, EVERYBODY_OUT = {"COMMAND", "REPEAT", "REPEAT_REQUEST"}, {"STATUS", "PARAMETERS", "REPEAT", "REPEAT_REQUEST"}  # the host of a module, common/bus/process.cpp


def files(*folders, suffixes=SOURCES):
    for folder in folders:
        yield from sorted(p for p in (HOUSE / folder).rglob("*") if p.suffix in suffixes)


def code(path):
    """A C++ file without comments and strings, so that words in them break no rule."""
    text = re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.S)
    return re.sub(r"//[^\n]*", "", text)


def breaches(paths, rules):
    """Every line that matches one of `rules` (pattern: what is wrong)."""
    found = []
    for path in paths:
        for number, line in enumerate(code(path).splitlines(), 1):
            for pattern, wrong in rules.items():
                if re.search(pattern, line):
                    found.append(f"{path.relative_to(HOUSE)}:{number}: {wrong}: {line.strip()}")
    return found


def pure_files():
    return [p for p in files("common", suffixes={".cpp", ".hpp"}) if p.relative_to(HOUSE).parts[1] != "bus"]


@test("nothing in common/ but common/bus knows LCM or its messages")
def no_lcm():
    check(len(pure_files()) > 40, "common/ was not found")
    equal(breaches(pure_files(), {r'#include [<"](lcm/|bot_core/|modslam/)': "includes LCM or a message",
                                  r'#include [<"](common/bus/|procs/|viewer/)': "includes a layer above"}), [], "breaches")


@test("nothing in common/ but common/bus has a thread, a clock, the terminal or, outside of common/formats, a file")
def pure():
    rules = {r"std::(thread|mutex|async|atomic|condition_variable)": "a thread",
             r"(steady|system|high_resolution)_clock|gettimeofday|clock_gettime|\btime\(": "a clock",
             r"std::(cout|cerr|clog)|\b(std::)?(printf|puts|fprintf)\(": "prints",
             r"std::random_device|\bs?rand\(": "randomness without a seed"}
    equal(breaches(pure_files(), rules), [], "breaches")
    not_formats = [p for p in pure_files() if "formats" not in p.parts]
    equal(breaches(not_formats, {r"\b[io]?fstream\b|\bfopen\(|std::filesystem": "a file"}), [], "breaches")


@test("common/bus knows no process, and no folder of procs/ includes another but the hosts that hold modules")
def processes_apart():
    equal(breaches(files("common", suffixes={".cpp", ".hpp"}), {r'#include "(procs|viewer)/': "includes a process"}), [], "breaches")
    found = []
    for path in files("procs", "viewer", suffixes={".cpp", ".hpp"}):
        parts = path.relative_to(HOUSE).parts
        own = "viewer" if parts[0] == "viewer" else f"procs/{parts[1]}"
        for included in re.findall(r'#include "((?:procs/[^/"]+|viewer)/[^"]*)"', code(path)):
            if not included.startswith(own + "/"):
                found.append(f"{path.relative_to(HOUSE)} includes {included}")
    equal(found, [], "breaches")


@test("config/modslam.toml is what modslam-config --defaults prints")
def defaults():
    printed = subprocess.run([BIN / "modslam-config", "--defaults"], capture_output=True, text=True, check=True).stdout
    check(printed == (HOUSE / "config" / "modslam.toml").read_text(),
          "they differ; make it anew: build/bin/modslam-config --defaults > config/modslam.toml")


@test(f"no source file is longer than {LONGEST_FILE_LINES} lines, and each names its licence")
def sizes():
    long = {}
    for path in [*files(*FOLDERS), HOUSE / "run.sh"]:
        lines = path.read_text().splitlines()
        if len(lines) > LONGEST_FILE_LINES:
            long[str(path.relative_to(HOUSE))] = len(lines)
    equal(long, {}, "long files")
    bare = [str(p.relative_to(HOUSE)) for p in files("common", "procs", "viewer", "tests", suffixes={".cpp", ".hpp", ".py", ".sh"})
            if "SPDX-License-Identifier: BSD-3-Clause" not in "\n".join(p.read_text().splitlines()[:3])]
    equal(bare, [], "files without their licence line")


# --- docs/architecture.md against the sources ---

def channel_names():
    text = (HOUSE / "common" / "bus" / "channels.hpp").read_text()
    return dict(re.findall(r'constexpr const char\* k(\w+) = "(\w+)";', text))


def spoken_in(text):
    """Channels in and out of a piece of source: what is published goes out, counted gaps and comparisons are neither."""
    ins, outs, names = set(), set(), channel_names()
    text = re.sub(r"(count_gap\(|[=!]=)\s*channel::k\w+", "", text)
    for word, name in re.findall(r"(\w*)(?:<[^<>]*>)?\(\s*channel::k(\w+)", text):
        (outs if word.startswith("publish") else ins).add(names[name])
    for name in re.findall(r"(?<!\()channel::k(\w+)", re.sub(r"\(\s*channel::", "(channel::", text)):
        ins.add(names[name])
    return ins, outs


def folder_channels(folder):
    text = "\n".join(code(p) for p in sorted(folder.glob("*.cpp")) + sorted(folder.glob("*.hpp")))
    ins, outs = spoken_in(text)
    for name, stem in HELPERS.items():
        if re.search(rf"\b{name}>? \w+_[;{{]|\b{name}\b \w+\{{", text):
            bus = HOUSE / "common" / "bus"
            more = spoken_in(code(bus / f"{stem}.hpp") + code(bus / f"{stem}.cpp"))
            ins, outs = ins | more[0], outs | more[1]
    return ins, outs


def process_folders():
    """Folders whose main hosts a module on the network."""
    for main in [*sorted(HOUSE.glob("procs/*/main.cpp")), HOUSE / "viewer" / "main.cpp"]:
        if "run_process(" in main.read_text():
            yield main.parent


def table(heading):
    """Rows of the first table below a heading of docs/architecture.md."""
    text = (HOUSE / "docs" / "architecture.md").read_text()
    check(f"## {heading}\n" in text, f"docs/architecture.md has no section '{heading}'")
    lines = text.split(f"## {heading}\n", 1)[1].split("\n## ", 1)[0].splitlines()
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines if line.startswith("|")]
    return rows[2:]


def channels_in(cell):
    return set(re.findall(r"\b[A-Z]{3,}(?:_[A-Z]+)*\b", cell)) & set(channel_names().values())


@test("the table of processes in docs/architecture.md names each process with the channels that its sources use")
def process_table():
    rows = {row[0].strip("`"): row for row in table("Processes")}
    folders = {folder.name: folder for folder in process_folders()}
    check(len(folders) > 8, "no processes were found")
    equal(sorted(rows), sorted(folders), "processes in the table and in the tree")
    wrong = []
    for name, folder in folders.items():
        ins, outs = folder_channels(folder)
        ins, outs = ins - EVERYBODY_IN, outs - EVERYBODY_OUT
        for what, source, cell in (("in", ins, rows[name][1]), ("out", outs, rows[name][2])):
            if source != channels_in(cell):
                wrong.append(f"{name} {what}: sources {sorted(source)}, table {sorted(channels_in(cell))}")
    equal(wrong, [], "differences")


@test("docs/messages.md lists every channel with who speaks, who listens and a type that exists")
def channel_table():
    text = (HOUSE / "docs" / "messages.md").read_text()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("| `")]
    equal(sorted(row[0].strip("`") for row in rows), sorted(channel_names().values()), "channels")
    speakers, listeners = {}, {}
    for folder in process_folders():
        ins, outs = folder_channels(folder)
        for name in ins - EVERYBODY_IN:
            listeners.setdefault(name, set()).add(folder.name)
        for name in outs - EVERYBODY_OUT:
            speakers.setdefault(name, set()).add(folder.name)
    wrong = []
    for channel, kind, spoken, heard, *_ in rows:
        channel = channel.strip("`")
        package, _, name = kind.strip("`").partition(".")
        if not (HOUSE / "lcmtypes" / f"{package}_{name}.lcm").exists():
            wrong.append(f"{channel}: no type {kind}")
        if channel in EVERYBODY_IN | EVERYBODY_OUT:
            continue
        for what, cell, source in (("spoken by", spoken, speakers), ("heard by", heard, listeners)):
            told = set(re.findall(r"\w+", cell)) & {folder.name for folder in process_folders()}
            if told != source.get(channel, set()):
                wrong.append(f"{channel} {what}: sources {sorted(source.get(channel, set()))}, table {sorted(told)}")
    equal(wrong, [], "differences")


@test("every file that docs/architecture.md sends a reader to exists")
def paths_exist():
    missing = []
    for name in ("architecture.md", "messages.md"):
        text = (HOUSE / "docs" / name).read_text()
        for path in re.findall(r"`((?:common|procs|viewer|config|lcmtypes|tests|docs|logs)/[\w./*-]+)`", text):
            if not list(HOUSE.glob(path.rstrip("/"))):
                missing.append(path)
    equal(missing, [], "paths that do not exist")


@test("every file that names its interpreter can be run, and no other says it can")
def scripts_can_be_run():
    wrong = [str(p.relative_to(HOUSE)) for p in [HOUSE / "run.sh", HOUSE / ".ci" / "run", *files("procs", "tests", "viewer", "common", suffixes={".py", ".sh"})]
             if p.read_text().startswith("#!") != os.access(p, os.X_OK)]
    equal(wrong, [], "files whose mode and first line disagree")


@test("every shell script stops at unset names, and shellcheck finds nothing in it")
def strict_scripts():
    scripts = [HOUSE / "run.sh", HOUSE / ".ci" / "run", *files("procs", "tests", suffixes={".sh"})]
    check(len(scripts) > 5, "the scripts were not found")
    lax = [str(p.relative_to(HOUSE)) for p in scripts
           if p.read_text().startswith("#!") and not re.search(r"^set -e?uo? ?(pipefail)?$", p.read_text(), flags=re.M)]
    equal(lax, [], "scripts that go on after an error or an unset name")
    own = [p for p in scripts if p.read_text().startswith("#!")]  # the others are read where they are sourced
    run = subprocess.run(["shellcheck", "-x", "-a", *own], cwd=HOUSE, capture_output=True, text=True, check=False)
    equal(run.stdout, "", "shellcheck")


if __name__ == "__main__":
    system.main()
