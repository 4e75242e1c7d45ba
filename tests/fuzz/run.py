#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""run.py BUILD_DIR [SECONDS [TARGET...]]: builds the fuzz targets with clang into BUILD_DIR/fuzz and runs each for so long.

Seeds: a drive that modslam-simulate writes, cut into messages, and what stands in tests/fuzz/seeds. What is found stays in
BUILD_DIR/fuzz/found. Exits 77 where there is no clang.
"""
import pathlib
import re
import shutil
import subprocess
import sys

HOUSE = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
TARGETS = ["messages", "log", "text_log", "rawlog", "config", "repeats"]
CHANNELS = {"LASER": 0, "ODOMETRY": 1, "NODE": 5, "GRAPH": 6, "LOOP": 7, "LOOP_SEARCH": 8, "MAP_TILE": 9, "PARAMETERS": 12, "POSE": 13,
            "STATUS": 14, "SEMANTIC_ROOMS": 15, "SEMANTIC_DOORS": 3, "SEMANTIC_OBJECTS": 11, "SEMANTIC_WALLS": 21, "SCAN_MATCH": 16,
            "SENSOR_INFO": 17, "SIM_INFO": 18, "SEMANTIC_PLACES": 22, "QUERY": 23, "ANSWER": 24, "REPEAT_REQUEST": 25}
LARGEST = {"messages": 4096, "log": 4096, "text_log": 2048, "rawlog": 4096, "config": 2048, "repeats": 512}


def build(folder):
    if not (folder / "build.ninja").exists():
        subprocess.run(["cmake", "-G", "Ninja", "-S", HOUSE, "-B", folder, "-DCMAKE_CXX_COMPILER=clang++", "-DCMAKE_C_COMPILER=clang",
                        "-DMODSLAM_FUZZ=ON", "-DMODSLAM_WERROR=OFF", "-DMODSLAM_SANITIZE=address,undefined,fuzzer-no-link",
                        "-DCMAKE_BUILD_TYPE=Release"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", folder, *(f"fuzz-{target}" for target in TARGETS)], check=True, stdout=subprocess.DEVNULL)


def seed(build_dir, folder):
    """Real messages, a real log, and the shipped configuration."""
    sys.argv = [sys.argv[0], str(build_dir)]
    sys.path.insert(0, str(HOUSE / "tests" / "support"))
    import system
    for target in TARGETS:
        (folder / target).mkdir(parents=True, exist_ok=True)
        for path in (HOUSE / "tests" / "fuzz" / "seeds" / target).glob("*"):
            shutil.copy(path, folder / target)
    shutil.copy(HOUSE / "config" / "modslam.toml", folder / "config")
    log, run = folder / "drive.lcm", folder / "run"
    if not log.exists():
        for words in ([build_dir / "bin" / "modslam-simulate", log, "--set", "simulator.route=C_bedroom_full"],
                      [build_dir / "bin" / "modslam-offline", log, "--out", run]):
            subprocess.run(words, check=True, stdout=subprocess.DEVNULL, cwd=HOUSE)
    counts = {}
    for _, channel, data in system.events(run / "run.lcm"):
        counts[channel] = counts.get(channel, 0) + 1
        if channel in CHANNELS and counts[channel] in (1, 20):
            (folder / "messages" / f"{channel}-{counts[channel]}").write_bytes(bytes([CHANNELS[channel]]) + data[8:])
    (folder / "log" / "start").write_bytes((run / "run.lcm").read_bytes()[:3000])


def fuzz(folder, target, seconds):
    """@return whether nothing was found. Leaks are looked for once, at the end: after each run of a target that keeps caches it takes all the time."""
    found = folder / "found"
    found.mkdir(exist_ok=True)
    done = subprocess.run([folder / "bin" / f"fuzz-{target}", folder / "corpus" / target, f"-max_total_time={seconds}", f"-max_len={LARGEST[target]}",
                           "-timeout=5", "-detect_leaks=0", "-rss_limit_mb=3000", "-malloc_limit_mb=2000", f"-artifact_prefix={found}/{target}-", "-print_final_stats=1", "-seed=1"],
                          capture_output=True, text=True, errors="replace", check=False)
    runs = re.search(r"number_of_executed_units: (\d+)", done.stderr)
    what = "nothing found" if done.returncode == 0 else f"something found: {found}/{target}-*"
    print(f"{'ok' if done.returncode == 0 else 'FAIL'} fuzz {target}: {runs.group(1) if runs else '?'} executions in {seconds} s, {what}", flush=True)
    if done.returncode != 0:
        print(done.stderr[-3000:])
    return done.returncode == 0


def main():
    build_dir = pathlib.Path(sys.argv[1]).resolve()
    seconds = int(sys.argv[2]) if len(sys.argv) > 2 else 4
    targets = sys.argv[3:] or TARGETS
    if not shutil.which("clang++"):
        print("no clang++ here: apt-get install clang")
        sys.exit(77)
    folder = build_dir / "fuzz"
    build(folder)
    seed(build_dir, folder / "corpus")
    sys.exit(0 if all([fuzz(folder, target, seconds) for target in targets]) else 1)


if __name__ == "__main__":
    main()
