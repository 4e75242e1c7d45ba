#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""viewer_bench.py BIN [--json F] [--markdown F] [--picture F] [--port N]: frames a second of the page and the viewer's share of a
core with a generated building of 10,000 nodes, 1,000 rooms and 40 scans a second, one page in headless Chromium without a GPU."""
import argparse
import json
import os
import socket
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(__file__))
from webdriver import Browser, free_port  # noqa: E402

SITUATIONS = {  # what happens before every frame
    "everything in view, robot moving": "m.camera.mode = 'fit'",
    "followed at 20 pixels a metre": "m.camera.scale = 20; m.camera.mode = 'robot'",
    "dragged, everything in view": "m.camera.mode = 'free'; m.camera.scale = 3; m.camera.x = 95 + 10 * Math.sin(n / 20); m.camera.y = 95",
    "zoomed in and out": "m.camera.mode = 'free'; m.camera.x = m.camera.y = 95; m.camera.scale = 3 * Math.exp(1.5 + 1.5 * Math.sin(n / 30))",
}
MEASURE = """const [seconds, before] = arguments, m = window.modslam, each = new Function('m', 'n', before);
window.measured = null;
const times = [], start = performance.now();
const frame = (now) => {
  times.push(now);
  each(m, times.length);
  m.touch();
  if (now - start < seconds * 1000) return requestAnimationFrame(frame);
  const gaps = times.slice(1).map((t, i) => t - times[i]).sort((a, b) => a - b);
  window.measured = {fps: 1000 * gaps.length / (times.at(-1) - times[0]), p99_ms: gaps[Math.floor(gaps.length * 0.99)]};
};
requestAnimationFrame(frame);"""


def cpu_s(pid):
    fields = open(f"/proc/{pid}/stat").read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def memory_mb(pid):
    return int(open(f"/proc/{pid}/statm").read().split()[1]) * os.sysconf("SC_PAGESIZE") / 1e6


def deaf_page(port):
    """A WebSocket that is opened and never read."""
    s = socket.create_connection(("127.0.0.1", port))
    s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    s.sendall(f"GET /ws HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
              "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
    return s


def share_of_core(pid, seconds):
    before, start = cpu_s(pid), time.monotonic()
    time.sleep(seconds)
    return 100 * (cpu_s(pid) - before) / (time.monotonic() - start)


def measure(options, viewer, port):
    browser = Browser()
    try:
        browser.open(f"http://127.0.0.1:{port}/")
        deadline = time.time() + 60
        while not browser.run("const m = window.modslam; return m.state.nodes.length >= 10000 && m.state.rooms.length >= 1000 && "
                              "[...m.state.tiles.values()].every((t) => t.cells)"):
            if time.time() > deadline:
                raise SystemExit("the page has not everything after a minute")
            time.sleep(0.5)
        result = {"frames": {}, "viewer_share_percent": share_of_core(viewer.pid, 10)}
        for name, before in SITUATIONS.items():
            browser.run(MEASURE, 5, before)
            while not (measured := browser.run("return window.measured")):
                time.sleep(0.3)
            result["frames"][name] = measured
        if options.picture:
            browser.run("const m = window.modslam; m.camera.mode = 'fit'; m.touch()")
            time.sleep(2)
            browser.screenshot(options.picture)
    finally:
        browser.close()
    result["memory_mb"] = memory_mb(viewer.pid)
    deaf = [deaf_page(port) for _ in range(4)]
    time.sleep(10)
    result["memory_with_four_deaf_pages_mb"] = memory_mb(viewer.pid)
    for s in deaf:
        s.close()
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("programs", help="folder of modslam-viewer and publish_big")
    parser.add_argument("--json")
    parser.add_argument("--markdown")
    parser.add_argument("--picture")
    options = parser.parse_args()
    url, port = f"udpm://239.255.76.67:{30000 + os.getpid() % 2000}?ttl=0&recv_buf_size=2097152", free_port()
    with tempfile.NamedTemporaryFile(suffix=".toml") as config:
        viewer = subprocess.Popen([f"{options.programs}/modslam-viewer", "--config", config.name, "--url", url, "--set", f"viewer.port={port}"])
        time.sleep(1)
        big = subprocess.Popen([f"{options.programs}/publish_big", "--url", url], stdout=subprocess.PIPE, text=True)
        try:
            big.stdout.readline()
            result = measure(options, viewer, port)
        finally:
            for process in (big, viewer):
                process.terminate()
                process.wait(10)
    lines = ["| page | frames/s | 99 % of frames within |", "|---|---|---|"]
    lines += [f"| {name} | {f['fps']:.0f} | {f['p99_ms']:.0f} ms |" for name, f in result["frames"].items()]
    lines += ["", f"The viewer takes {result['viewer_share_percent']:.1f} % of one core and {result['memory_mb']:.0f} MB; "
              f"{result['memory_with_four_deaf_pages_mb']:.0f} MB after 10 s with four pages that never read."]
    print("\n".join(lines))
    for path, text in ((options.json, json.dumps(result, indent=1)), (options.markdown, "\n".join(lines))):
        if path:
            with open(path, "w", encoding="utf-8") as file:
                file.write(text + "\n")


if __name__ == "__main__":
    main()
