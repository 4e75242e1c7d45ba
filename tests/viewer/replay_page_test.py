#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""replay_page_test.py BUILD_DIR: the page during a real replay, in real browsers: the past, a killed process, the player, two pages."""
import base64
import os
import pathlib
import shutil
import signal
import socket
import sys
import time

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "support")]
import system  # noqa: E402
from system import Run, Skip, check, equal, test  # noqa: E402
from webdriver import Browser  # noqa: E402


class Shared:
    """One replay and its first page, for all tests."""

    run = page = None


def state(expression, page=None):
    return (page or Shared.page).run("const m = window.modslam; return " + expression)


def until(expression, words, seconds=20, page=None):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = state(expression, page)
        if found:
            return found
        time.sleep(0.1)
    raise AssertionError(f"{words}: not within {seconds} s: {expression}")


def address():
    return f"http://127.0.0.1:{Shared.run.current()['PAGE_PORT']}/"


@test("the page of a real replay draws map, path, rooms and plots")
def begins():
    for tool in ("chromium", "chromedriver"):
        if not shutil.which(tool):
            raise Skip(f"{tool} is not installed")
    log = system.simulated_log("drive.lcm", "simulator.route=C_bedroom_full")
    Shared.run = Run("replay", log, "--drive", "--speed", "8", "--out", system.FOLDER / "run").__enter__()
    Shared.run.until(lambda: "Replaying" in Shared.run.said() and "PAGE_PORT" in Shared.run.current(), 60, "the replay begins")
    Shared.page = Browser()
    Shared.page.open(address())
    until("m.state.nodes.length > 15 && [...m.state.tiles.values()].some((t) => t.cells)", "nodes and a map", 40)
    until("document.querySelectorAll('#plots canvas').length >= 4 && m.live.series.error_m.some((v) => v > 0)", "plots with the error")
    equal(Shared.page.console(), [], "what the browser complained of")


@test("the page pauses, steps and speeds up the replay itself")
def player():
    Shared.page.run("document.getElementById('replay-play').click()")
    until("m.live.playback.paused", "paused")
    until("document.getElementById('replay-play').textContent === 'Play'", "the button says what it would do")
    before = state("m.live.playback.position_s")
    time.sleep(0.6)
    equal(state("m.live.playback.position_s"), before, "position while paused")
    Shared.page.run("document.getElementById('replay-step').click()")
    until(f"m.live.playback.position_s > {before}", "a step")
    check(state("m.live.playback.position_s") - before < 1, "a step is one scan")
    Shared.page.run("const s = document.getElementById('replay-speed'); s.value = '4'; s.onchange()")
    until("m.live.playback.speed === 4", "another speed")
    Shared.page.keys("k")
    until(f"!m.live.playback.paused && m.live.playback.position_s > {before} + 2", "goes on")


@test("scrubbing back shows the earlier map, and live goes on behind it")
def scrub():
    until("m.live.nodes.length > 30", "a longer path", 30)
    begin, end = state("m.live.clock.past")
    Shared.page.run("const t = document.getElementById('time'); t.value = arguments[0]; t.dispatchEvent(new Event('input'))",
                    (end - begin) / 1e6 / 3)
    until("m.state !== m.live && m.state.pose", "a state of the past")
    past, now = state("[m.state.nodes.length, m.live.nodes.length]")
    check(0 < past < 0.7 * now, f"{past} nodes then, {now} now")
    check(state("m.state.pose.utime") <= begin + (end - begin) / 2, "the pose is of then")
    check(state("[...m.state.tiles.values()].every((t) => t.cells)"), "tiles of then")
    until(f"m.live.nodes.length > {now}", "live grows meanwhile")
    equal(state("m.state.nodes.length"), past, "the past stands still")
    Shared.page.keys(" ")
    until(f"m.state.nodes.length > {past} || m.state === m.live", "the past is played")
    Shared.page.keys("l")
    until("m.state === m.live && document.getElementById('live').getAttribute('aria-pressed') === 'true'", "live again")


@test("a killed process is told of, turns red when silent, and green when supervisor started it again")
def killed():
    row = "document.querySelector('#processes [data-process=\"map_builder\"]')"
    pid = state("m.live.processes.get('map_builder').pid")
    os.kill(pid, signal.SIGSTOP)
    until(f"{row}.className === 'bad'", "red", 8)
    os.kill(pid, signal.SIGKILL)
    until(f"{row}.className === 'good' && m.live.processes.get('map_builder').pid !== {pid}", "green again, another pid", 10)
    until("m.live.events.some((e) => e[2] === 'map_builder was started again')", "an event says so")


@test("two browsers see the same, each with a layout of its own that stands in its address")
def two():
    second = Browser(width=900, height=700, dark=True)
    try:
        second.open(address() + "#layers=raster,path&view=robot&scale=30&panel=0&theme=dark")
        until("m.state.nodes.length > 30", "the second page has the path", page=second)
        equal(state("[[...m.visible], m.camera.mode, document.documentElement.dataset.theme]", second),
              [["raster", "path"], "robot", "dark"], "layout from the address")
        second.keys("9")
        until("location.hash.includes('raster,path,scan')", "the address follows", page=second)
        check("scan" in state("[...m.visible]"), "the first page keeps its own")
        check(state("m.connected"), "the first page is still connected")
        if os.environ.get("MODSLAM_PICTURES"):
            second.screenshot(os.path.join(os.environ["MODSLAM_PICTURES"], "replay-dark.png"))
            Shared.page.screenshot(os.path.join(os.environ["MODSLAM_PICTURES"], "replay.png"))
    finally:
        second.close()


def ask(text):
    """@return the status line of the answer."""
    with socket.create_connection(("127.0.0.1", int(Shared.run.current()["PAGE_PORT"])), timeout=5) as s:
        s.sendall(text.encode())
        return s.recv(200).decode(errors="replace").split("\r\n")[0]


def upgrade(host, origin):
    key = base64.b64encode(b"0123456789abcdef").decode()
    return (f"GET /ws HTTP/1.1\r\nHost: {host}\r\nOrigin: {origin}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n")


@test("strangers are kept out: other origins, foreign names, other addresses of this machine, and a flood slows no process")
def strangers():
    own = f"127.0.0.1:{Shared.run.current()['PAGE_PORT']}"
    check("101" in ask(upgrade(own, f"http://{own}")), "the own page is let in")
    for host, origin in ((own, "http://evil.example"), ("evil.example", "http://evil.example"), (own, "null"),
                         (own, "http://127.0.0.1:1")):
        check("403" in ask(upgrade(host, origin)), f"Host {host} with Origin {origin} is refused")
    listening = os.popen("ss -Hltn").read()
    lines = [line.split()[3] for line in listening.splitlines() if line.split()[3].endswith(":" + own.split(":")[1])]
    equal(lines, [own], "addresses listened on")
    matched = "m.live.clock.channels.find((c) => c.channel === 'POSE').received"
    pid = state("m.live.processes.get('viewer').pid")
    cpu = lambda: sum(map(int, pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[11:13])) / os.sysconf("SC_CLK_TCK")
    poses, spent, start = state(matched), cpu(), time.monotonic()
    statuses = [ask(f"GET /past?utime=1 HTTP/1.1\r\nHost: {own}\r\n\r\n") for _ in range(600)]
    seconds = time.monotonic() - start
    check(any("429" in status for status in statuses), "a flood is told that it is too much")
    check((cpu() - spent) / seconds < 0.5, f"the viewer took {(cpu() - spent) / seconds:.2f} of a core")
    check(state(matched) > poses or state("m.live.playback.ended"), "poses go on")
    check(state("m.connected"), "the page stays connected")


@test("the run ends as any other, with its results")
def ends():
    Shared.page.run("m = window.modslam; m.timeline.send('speed 20')")
    Shared.page.close()
    code = Shared.run.wait(90)
    equal(code, 0, "exit code of run.sh:\n" + Shared.run.said())
    check((system.FOLDER / "run" / "report.html").exists(), "a report")


if __name__ == "__main__":
    try:
        system.main()
    finally:
        if Shared.run:
            Shared.run.__exit__()
