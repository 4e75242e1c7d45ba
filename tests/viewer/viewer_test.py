#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""viewer_test.py BIN [--pictures DIR]: the viewer's page in a real Chromium, fed by publish_sample. Exit 77: skipped."""
import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(__file__))
from webdriver import Browser, free_port  # noqa: E402

EVIL = '<img src=x onerror="window.hacked=1">'
ROOMS = {"Library": 20.0, "Kitchen": 12.0, "Workshop": 20.0, "Room 4": 24.0, EVIL: 28.0, "Corridor": 26.0}


def skip(why):
    print("skipped:", why)
    sys.exit(77)


def check(holds, sentence):
    print("ok  " if holds else "FAIL", sentence, flush=True)
    if not holds:
        raise AssertionError(sentence)


class Run:
    """The sample publisher, a viewer and a browser that has the page open."""

    def __init__(self, programs):
        self.programs = programs
        self.folder = tempfile.mkdtemp(prefix="modslam-viewer-")
        self.config = os.path.join(self.folder, "empty.toml")
        open(self.config, "w").close()
        self.url = f"udpm://239.255.76.67:{20000 + os.getpid() % 20000}?ttl=0"
        self.port = free_port()
        self.sample = subprocess.Popen([f"{programs}/publish_sample", "--url", self.url, "--speed", "10"],
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.sample.stdout.readline()
        self.viewer = None
        self.start_viewer()
        self.browser = Browser()

    def viewer_command(self):
        return [f"{self.programs}/modslam-viewer", "--config", self.config, "--url", self.url, "--set",
                f"viewer.port={self.port}"]

    def start_viewer(self):
        self.viewer = subprocess.Popen(self.viewer_command(), stderr=subprocess.PIPE, text=True)
        try:
            self.viewer.wait(1.0)
        except subprocess.TimeoutExpired:
            return
        words = self.viewer.stderr.read()
        if "multicast" in words:
            skip(words.strip())
        raise AssertionError("the viewer did not start: " + words)

    def tell(self, line):
        self.sample.stdin.write(line + "\n")
        self.sample.stdin.flush()

    def state(self, expression):
        return self.browser.run("const m = window.modslam; return " + expression)

    def wait(self, expression, sentence, seconds=20):
        deadline = time.time() + seconds
        while time.time() < deadline:
            if self.state(expression):
                return check(True, sentence)
            time.sleep(0.1)
        check(False, sentence + f" (waited {seconds} s for {expression})")

    def on_screen(self, x, y):
        return self.state(f"m.camera.toScreen({x}, {y})")

    def click_map(self, x, y):
        px, py = self.on_screen(x, y)
        self.browser.mouse(("move", px, py), ("down",), ("up",))

    def color_at(self, x, y):
        """The painted colour at a map point, on the next painting."""
        self.wait_paint()
        return self.state(f"""(() => {{ const c = document.getElementById('map'), [px, py] = m.camera.toScreen({x}, {y});
            const k = c.width / c.clientWidth;
            return [...c.getContext('2d').getImageData(px * k, py * k, 1, 1).data]; }})()""")

    def wait_paint(self):
        before = self.state("m.paints")
        deadline = time.time() + 5
        while self.state("m.paints") <= before + 1 and time.time() < deadline:
            time.sleep(0.05)

    def stop(self):
        for process in (self.viewer, self.sample):
            process.terminate()
            process.wait(10)
        if hasattr(self, "browser"):
            self.browser.close()
        shutil.rmtree(self.folder, ignore_errors=True)


def test_everything_arrives(run):
    run.browser.open(f"http://127.0.0.1:{run.port}/")
    run.wait("m.connected", "the page connects")
    run.wait("m.state.rooms.length === 6", "six rooms are found", 60)
    run.wait("[...m.state.tiles.values()].filter((t) => t.cells).length >= 6", "tiles are unpacked")
    run.wait("m.state.nodes.length > 50 && m.state.nodes.every(Boolean)", "the path has no hole")
    run.wait("m.state.edges.length > 0", "loop edges are known", 60)
    run.wait("m.state.walls.length >= 14 && m.state.doors.length === 6 && m.state.objects.length === 2",
             "walls, doors and objects are known", 60)
    run.wait("m.state.places.length > 100 && new Set(m.state.places.filter((_, i) => i % 2 === 0)).size === 3",
             "rooms, corridors and doorways are told apart along the path", 60)
    run.wait("m.state.scan.points.length > 600", "a scan is shown")
    apart = run.state("""(() => { const near = (p) => Math.min(...m.state.nodes.map((q) => Math.hypot(p[0] - q[0], p[1] - q[1])));
        return Math.max(...m.state.truth.slice(0, 300).map(near)); })()""")
    check(apart < 0.6, f"the true path lies over the estimated one (at most {apart:.2f} m to the next node)")


def test_names_are_only_text(run):
    run.wait("document.querySelectorAll('#rooms li').length === 6", "the rooms are listed")
    names = run.state("[...document.querySelectorAll('#rooms .name')].map((n) => n.textContent)")
    check(sorted(names) == sorted(ROOMS), "each has its name")
    check(run.state("document.querySelectorAll('#panel img').length") == 0, "a name never becomes markup")
    check(run.state("window.hacked === undefined"), "a name never becomes a program")


def test_selecting(run):
    run.click_map(1.0, 3.0)
    run.wait("document.getElementById('selection-title').textContent === 'Library'", "a click finds the room")
    fields = run.state("document.getElementById('selection-fields').textContent")
    check("20.0 m²" in fields, "the room's area is told")
    run.click_map(6.45, 2.0)
    run.wait("m.selected?.kind === 'doors'", "a click finds the door")
    fields = run.state("document.getElementById('selection-fields').textContent")
    check("Kitchen and Corridor" in fields and "0.90 m" in fields, "the door tells its rooms and width")
    run.click_map(13.0, 1.0)
    run.wait("m.selected?.kind === 'walls'", "a click finds the wall")
    run.browser.run("[...document.querySelectorAll('#rooms button')].find((b) => b.textContent.startsWith('Workshop')).click()")
    run.wait("m.selected?.kind === 'rooms' && m.selected.id === 3", "the list finds the room")
    run.browser.keys("\ue00c")
    run.wait("m.selected === null && document.getElementById('selection').hidden", "Escape lets it go")


# Middles of the occupied cells on the left wall.
CELLS_OF_WALLS = """(() => {
  const out = [];
  for (const t of m.state.tiles.values())
    for (let k = 0; k < t.cells.length; k++) {
      const x = (t.x * t.ncells + k % t.ncells + 0.5) * t.resolution, y = (t.y * t.ncells + Math.floor(k / t.ncells) + 0.5) * t.resolution;
      if (t.cells[k] > 200 && m.state.walls.some((w) => w.a[0] === w.b[0] && Math.abs(x - w.a[0]) < 0.05 && (y - w.a[1]) * (y - w.b[1]) < 0)) out.push([x, y]);
    }
  return out;
})()"""


def test_layers(run):
    for name in ("path", "graph", "scan", "truth"):
        run.browser.run(f"document.getElementById('layer-{name}').click()")
    filled = run.color_at(1.0, 3.0)
    run.browser.keys("2")
    check(run.color_at(1.0, 3.0) != filled, "key 2 takes the rooms' colour away")
    raster = run.color_at(1.0, 3.0)
    run.browser.keys("1")
    check(run.color_at(1.0, 3.0) != raster, "key 1 takes the grid map away")
    wall = run.color_at(13.0, 4.0)
    run.browser.keys("4")
    check(run.color_at(13.0, 4.0) != wall, "key 4 takes the walls away")
    run.browser.keys("124")
    check(run.color_at(1.0, 3.0) == filled and run.color_at(13.0, 4.0) == wall, "they come back")
    run.browser.keys("4c")
    occupied = run.state(CELLS_OF_WALLS)
    check(len(occupied) > 50, "walls have occupied cells")
    shown = [run.color_at(x, y) for x, y in occupied[::len(occupied) // 20]]
    run.browser.keys("4c")
    bare = [run.color_at(x, y) for x, y in occupied[::len(occupied) // 20]]
    check(sum(a != b for a, b in zip(shown, bare)) > 15, "key c shows the occupied cells of walls as contours")
    x, y = run.state("m.state.nodes[2].slice(0, 2)")
    bare = run.color_at(x, y)
    run.browser.keys("o")
    check(run.color_at(x, y) != bare, "key o shows what kind of place a node is")
    run.browser.keys("o")
    check(run.color_at(x, y) == bare, "and takes it away again")
    for name in ("path", "graph", "scan", "truth"):
        run.browser.run(f"document.getElementById('layer-{name}').click()")


def test_moving(run):
    scale = run.state("m.camera.scale")
    run.browser.keys("+")
    run.wait(f"m.camera.scale > {scale} * 1.2", "plus zooms in")
    x = run.state("m.camera.x")
    run.browser.mouse(("move", 400, 400), ("down",), ("move", 450, 400), ("move", 500, 400), ("up",))
    run.wait(f"m.camera.x < {x} - 0.5 && m.camera.mode === 'free'", "dragging moves the map")
    run.browser.keys("f")
    run.wait("m.camera.mode === 'robot' && Math.hypot(m.camera.x - m.state.pose.pose[0], m.camera.y - m.state.pose.pose[1]) < 0.5",
             "F follows the robot")
    run.browser.keys("0")
    run.wait(f"Math.abs(m.camera.scale - {scale}) < 1", "0 shows everything")
    run.browser.mouse(("move", *run.on_screen(2, 5)))
    run.wait("(() => { const [x, y] = document.getElementById('cursor').textContent.match(/-?[0-9.]+/g); "
             "return Math.abs(x - 2) < 0.05 && Math.abs(y - 5) < 0.05; })()", "the place under the cursor is told")


def test_processes(run):
    row = "document.querySelector('#processes [data-process=\"%s\"]')"
    run.wait(row % "map_builder" + ".className === 'good'", "a running process is green")
    run.tell("trouble loop_detector")
    run.tell("silence map_builder")
    run.wait(row % "loop_detector" + ".className === 'bad'", "a troubled process is red", 5)
    run.wait(row % "map_builder" + ".className === 'bad' && " + row % "map_builder" + ".textContent.includes('silent')",
             "a silent process turns red", 8)
    check(run.state(row % "laser" + ".className") == "good", "the others stay green")
    run.tell("speak map_builder")
    run.tell("speak loop_detector")
    run.wait(row % "map_builder" + ".className === 'good'", "it turns green when it speaks again", 5)
    run.wait("[...document.querySelectorAll('#channels tr')].some((r) => r.textContent.startsWith('LASER') && "
             "Number(r.children[1].textContent) > 50)", "the table counts scans a second")


def test_viewer_restarts(run):
    taken = subprocess.run(run.viewer_command(), capture_output=True, text=True, timeout=20)
    check(taken.returncode == 1 and str(run.port) in taken.stderr, "a second viewer says that the port is taken")
    run.viewer.terminate()
    code = run.viewer.wait(10)
    check(code == 0, f"the viewer ends when asked (code {code})")
    run.wait("!m.connected && !document.getElementById('banner').hidden", "the page says that the viewer is gone", 5)
    run.start_viewer()
    run.wait("m.connected && m.state.nodes.length > 50 && m.state.rooms.length === 6 && m.state.tiles.size >= 6",
             "the page is whole again after the viewer restarted", 10)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("programs", help="folder of modslam-viewer and publish_sample")
    parser.add_argument("--pictures", help="folder to save screenshots in")
    options = parser.parse_args()
    for tool in ("chromium", "chromedriver"):
        if not shutil.which(tool):
            skip(f"{tool} is not installed (apt install chromium chromium-driver)")
    run = Run(options.programs)
    try:
        for test in (test_everything_arrives, test_names_are_only_text, test_selecting, test_layers, test_moving,
                     test_processes, test_viewer_restarts):
            test(run)
        check(run.state("document.documentElement.scrollWidth <= window.innerWidth"), "nothing sticks out of the window")
        if options.pictures:
            run.click_map(1.0, 3.0)
            time.sleep(1)
            run.browser.screenshot(os.path.join(options.pictures, "viewer.png"))
    finally:
        if options.pictures:
            run.browser.screenshot(os.path.join(options.pictures, "viewer-last.png"))
        run.stop()


if __name__ == "__main__":
    main()
