#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The demo as a person starts it: it ends by itself, shows what it found and leaves nothing behind."""
import json
import pathlib
import re
import struct
import sys
import zlib

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import system  # noqa: E402
from system import RESULTS, Run, check, equal, quick, settings, test  # noqa: E402

LONGEST_ERROR_M = 0.15


def png_size(path):
    data = path.read_bytes()
    equal(data[:8], b"\x89PNG\r\n\x1a\n", "map.png begins")
    at, pixels = 8, b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + size]
        equal(struct.unpack_from(">I", data, at + 8 + size)[0], zlib.crc32(kind + body), f"checksum of {kind}")
        if kind == b"IHDR":
            width, height = struct.unpack_from(">II", body)
        pixels += body if kind == b"IDAT" else b""
        at += 12 + size
    check(len(zlib.decompress(pixels)) >= width * height, "map.png holds fewer pixels than it says")
    return width, height


def check_results(folder):
    for name in RESULTS + ["truth.geojson"]:
        check((folder / name).stat().st_size > 0, f"{name} is empty")
    summary = system.summary(folder)
    width, height = png_size(folder / "map.png")
    equal((width, height), (summary["map"]["width_cells"], summary["map"]["height_cells"]), "size of map.png")
    check(re.search(r"^resolution: 0\.05", (folder / "map.yaml").read_text(), re.M), "map.yaml tells the resolution")
    for name in ("semantic.geojson", "truth.geojson"):
        equal(json.loads((folder / name).read_text())["type"], "FeatureCollection", name)
    equal(len(system.poses(folder / "path.tum")), summary["poses"], "poses in path.tum")
    words = [line.split()[0] for line in (folder / "graph.g2o").read_text().splitlines() if line]
    equal(words.count("VERTEX_SE2"), summary["graph"]["nodes"], "nodes in graph.g2o")
    equal(words.count("EDGE_SE2"), summary["graph"]["edges"], "edges in graph.g2o")
    check("</html>" in (folder / "report.html").read_text(), "report.html is whole")
    return summary


@test("the demo drives, maps, ends by itself and prints what it found, with one process for each part")
def demo():
    folder = system.FOLDER / "demo"
    port = system.free_port(kind=system.socket.SOCK_STREAM)
    words = settings("simulator.route=A_safe_loop", "simulator.speed=10", f"viewer.port={port}")
    with Run("demo", "--out", folder, *words) as run:
        run.until_driving()
        names = sorted(name for _, name in run.processes() if name.startswith("modslam-") and name != "modslam-conduct")
        expected = ["recorder", "watchdog", "simulator", "laser", "odometry", "ins", "scan-matcher", "graph-optimizer", "loop-detector",
                    "map-builder", "semantic-classifier", "viewer"]
        if "launch.semantics=false" in words:
            expected.remove("semantic-classifier")
        equal(names, sorted("modslam-" + name for name in expected), "processes")
        equal(run.wait(), 0, "exit code")
        said = run.said()
        run.leaves_nothing()
    check("path error" in said and "report.html" in said, f"no table was printed:\n{said}")
    summary = check_results(folder)
    check("ended by itself" not in said, f"a process died:\n{said}")
    worst = summary["error"]["aligned_at_first_pose"]["position_m"]["max"]
    check(worst < LONGEST_ERROR_M, f"the path is wrong by up to {worst} m")
    equal(summary["scans_without_pose"], 0, "scans without a pose")
    equal({name: p for name, p in summary["processes"].items() if p["bad"]}, {}, "processes that met bad messages")


@test("two runs side by side do not hear each other")
def side_by_side():
    routes = {"A_safe_loop": 8, "C_bedroom_full": 8}
    scans = {route: system.count(system.simulated_log(route + ".lcm", f"simulator.route={route}"), "LASER") for route in routes}
    runs = {route: Run("demo", "--out", system.FOLDER / route, *quick(f"simulator.route={route}",
                                                                     f"simulator.speed={speed}")) for route, speed in routes.items()}
    try:
        ports = {run.until(lambda run=run: run.current().get("PORT"), 60, "the run notes its port") for run in runs.values()}
        equal(len(ports), 2, "ports")
        for route, run in runs.items():
            equal(run.wait(), 0, f"exit code of {route}: {run.said()}")
            summary = system.summary(system.FOLDER / route)
            equal(summary["simulation"]["route"], route, "route in the summary")
            equal(summary["scans"], scans[route], f"scans of {route}")
            equal(summary["scans_without_pose"], 0, f"scans of {route} without a pose")
            run.leaves_nothing()
    finally:
        for run in runs.values():
            run.__exit__()


if __name__ == "__main__":
    system.main()
