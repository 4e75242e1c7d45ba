# SPDX-License-Identifier: BSD-3-Clause
"""As much of WebDriver as a test of one page needs: chromedriver speaks plain HTTP and JSON."""
import base64
import json
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Browser:
    """A headless Chromium with a fresh profile."""

    def __init__(self, width=1366, height=800, dark=False):
        self.profile = tempfile.mkdtemp(prefix="modslam-chromium-")
        port = free_port()
        self.driver = subprocess.Popen(["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
        self.base = f"http://127.0.0.1:{port}"
        self.session = None
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                 "--disable-background-networking", "--disable-component-update", "--disable-sync",
                 "--disable-dev-shm-usage", f"--user-data-dir={self.profile}",
                 f"--window-size={width},{height}"]
        if dark:
            flags.append("--force-dark-mode")
        wanted = {"capabilities": {"alwaysMatch": {"browserName": "chrome", "goog:chromeOptions": {
            "args": flags, "binary": shutil.which("chromium")}}}}
        deadline = time.time() + 20
        while True:
            try:
                self.session = self.call("POST", "/session", wanted)["sessionId"]
                return
            except urllib.error.HTTPError as error:
                raise RuntimeError(error.read().decode()) from None
            except OSError:
                if time.time() > deadline:
                    raise
                time.sleep(0.1)

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        with opener.open(request, timeout=60) as reply:
            return json.load(reply)["value"]

    def command(self, path, body=None, method="POST"):
        return self.call(method, f"/session/{self.session}{path}", body if method == "POST" else None)

    def open(self, url):
        self.command("/url", {"url": url})

    def run(self, script, *args):
        return self.command("/execute/sync", {"script": script, "args": list(args)})

    def keys(self, text):
        actions = [{"type": kind, "value": c} for c in text for kind in ("keyDown", "keyUp")]
        self.command("/actions", {"actions": [{"type": "key", "id": "keyboard", "actions": actions}]})

    def mouse(self, *steps):
        """Each step: ("move", x, y), ("down",) or ("up",); pixels of the window."""
        actions = []
        for what, *at in steps:
            if what == "move":
                actions.append({"type": "pointerMove", "x": round(at[0]), "y": round(at[1]), "duration": 20})
            else:
                actions.append({"type": "pointerDown" if what == "down" else "pointerUp", "button": 0})
        self.command("/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": actions}]})

    def screenshot(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.command("/screenshot", method="GET")))

    def console(self):
        """What the page complained of."""
        try:
            return [e for e in self.command("/se/log", {"type": "browser"}) if e["level"] == "SEVERE"]
        except urllib.error.HTTPError:
            return []

    def close(self):
        try:
            if self.session:
                self.command("", method="DELETE")
        finally:
            self.driver.terminate()
            self.driver.wait(10)
            shutil.rmtree(self.profile, ignore_errors=True)
