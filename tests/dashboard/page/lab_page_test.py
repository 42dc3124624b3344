"""The page in a browser beside a real lab: twenty simulated robots, every process as users start it.

  tests/in_private_network.sh /usr/bin/python3 tests/dashboard/page/lab_page_test.py FOLDER_OF_PROGRAMS EXPERIMENTS

77: no chromium or no selenium here. With LAB_LONG=1 the bus is silent for 30 s, else for 6 s.
"""

import json
import math
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

sys.dont_write_bytecode = True
from page_case import LOST_SERVER, Keys, PageTest, browser

PORT = 28490
SILENCE_S = 30 if os.environ.get("LAB_LONG") else 6
REACHED_MS = 200  # a stop, by every robot
# Two poses of a robot that stands differ by the tracker's noise, 0.04 cm in each direction; one that
# drives goes ten times as far in a second and a half.
MOVED_CM = 0.3


class Lab:
    """`lab run --web` and all it starts."""

    def __init__(self, programs, experiments, folder, name="swarm", *more):
        self.folder = pathlib.Path(folder)
        environment = dict(os.environ, XDG_RUNTIME_DIR=folder)
        self.output = open(self.folder / "output", "w+", encoding="utf-8")
        self.process = subprocess.Popen(
            [programs / "lab", "run", experiments / f"{name}.toml", "--web", "--no-report",
             "--out", self.folder / "runs", "--set", f"dashboard.port={PORT}", *more],
            stdout=self.output, stderr=subprocess.STDOUT, env=environment)

    def said(self):
        return (self.folder / "output").read_text(encoding="utf-8")

    def address(self):
        end = time.monotonic() + 20
        while time.monotonic() < end and self.process.poll() is None:
            found = re.search(r"web\s+(http://\S+#token=\S+)", self.said())
            if found:
                return found[1]
            time.sleep(0.05)
        raise AssertionError("no address in: " + self.said())

    def children(self):
        """pid by name of program."""
        found = {}
        for entry in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                parent = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
                name = pathlib.Path(os.readlink(entry / "exe")).name
            except OSError:
                continue
            if parent == self.process.pid:
                found[name] = int(entry.name)
        return found

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            return self.process.wait(30)
        finally:
            self.process.kill()
            self.process.wait()
            self.output.close()


class BesideALab(PageTest):
    server_goes = True
    token = True

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.lab = Lab(*ARGUMENTS, folder.name)
        self.addCleanup(self.lab.end)
        self.address = self.lab.address()
        self.addCleanup(browser.get, "about:blank")
        # So high that curves are in sight: what is not is not drawn.
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": 1280, "height": 2200, "deviceScaleFactor": 1, "mobile": False})
        browser.get_log("browser")
        browser.get(self.address)
        # Looked at from the first moment on, in the page itself.
        browser.execute_script("""
            window.seen = {};
            const note = (name, is) => { if (is && !seen[name]) seen[name] = performance.now(); };
            setInterval(() => {
              if (!window.labPage) return;
              note('analysis', labPage.stream.topics.has('pool/abp'));
              note('curve', labPage.charts.msd?.pointsDrawn() > 0);
            }, 20);""")
        self.live()

    def robots(self):
        return {robot["id"]: robot for robot in self.js("labPage.robots()")}

    def moved(self, wait=1.5):
        before = self.robots()
        time.sleep(wait)
        after = self.robots()
        return [i for i in after
                if i in before and math.hypot(after[i]["x"] - before[i]["x"],
                                              after[i]["y"] - before[i]["y"]) > MOVED_CM]

    def test_a_lab_is_seen_stopped_and_seen_again(self):
        self.until("labPage.robots().length === 20")
        self.assertGreater(len(self.moved()), 10)

        self.until("seen.curve", 20)
        after = self.js("seen.curve - seen.analysis")
        print(f"the MSD stands {after:.0f} ms after the first ANALYSIS")
        self.assertLess(after, 2000)

        self.press(Keys.SPACE)
        self.until("labPage.controls.stopText.startsWith('stopped: all 20 robots')")
        took = self.js("labPage.stream.topics.get('stop').took_ms")
        print(f"STOP reached all 20 robots in {took:.0f} ms; the page: {self.text('stop-state')}")
        self.assertLess(took, REACHED_MS)
        self.until("labPage.stream.topics.get('robots').every(robot => robot.stopped)")
        time.sleep(0.5)
        self.assertEqual([], self.moved())

        browser.refresh()
        self.live()
        self.until("labPage.controls.stopText.startsWith('stopped: all 20 robots')")
        self.assertTrue(self.js("labPage.controls.control"))

        self.wish("release_stop")
        self.until("labPage.stream.topics.get('stop').state === 'free'")
        self.assertGreater(len(self.moved()), 10)
        self.assertEqual([], self.console())

    def test_a_server_that_is_killed_comes_back(self):
        browser.execute_script("window.notReloaded = true")
        server = self.lab.children()["dashboard"]
        os.kill(server, signal.SIGSTOP)
        self.says("banner", "no message from the server since")
        os.kill(server, signal.SIGKILL)
        self.until("document.getElementById('banner').hidden", 20)
        self.until("labPage.robots().length === 20")
        self.assertTrue(self.js("window.notReloaded"))
        self.press(Keys.SPACE)  # the token is still the one
        self.until("labPage.controls.stopText.startsWith('stopped: all 20 robots')")
        self.assertEqual([], self.console())

    def test_a_lab_that_is_silent_is_waited_for(self):
        self.until("labPage.robots().length === 20")
        quiet = [pid for name, pid in self.lab.children().items() if name != "dashboard"]
        quiet.append(self.lab.process.pid)
        for pid in quiet:
            os.kill(pid, signal.SIGSTOP)
        try:
            self.says("banner", "no message from the lab for")
            time.sleep(SILENCE_S)
            self.assertIn("no message from the lab for", self.text("banner"))
        finally:
            for pid in quiet:
                os.kill(pid, signal.SIGCONT)
        self.until("document.getElementById('banner').hidden", 20)
        self.until("labPage.robots().length === 20")
        self.assertEqual([], self.console())

    def test_a_client_that_does_not_read_is_nobody_elses_trouble(self):
        slow = [socket.create_connection(("127.0.0.1", PORT)) for _ in range(5)]
        for client in slow:
            self.addCleanup(client.close)
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            client.sendall(b"GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % PORT)
        time.sleep(5)
        frames = self.js("labPage.view.arena.frames")
        time.sleep(2)
        came = self.js("labPage.view.arena.frames") - frames
        print(f"beside five clients that do not read: {came / 2:.0f} frames a second")
        self.assertGreater(came, 20)
        self.until("labPage.stream.topics.get('health').server.viewers >= 1")

    def test_a_script_is_paused_marked_and_ended_from_the_page(self):
        self.until("labPage.stream.topics.get('script')?.phase === 'script'", 20)
        self.wish("pause")
        self.until("labPage.stream.topics.get('script').phase === 'paused'")
        self.wish("resume")
        self.until("labPage.stream.topics.get('script').phase === 'script'")
        self.wish("mark", text="seen <b>by</b> the page")
        self.until("labPage.stream.topics.get('timeline').marks"
                   ".some(mark => mark.text === 'dashboard: seen <b>by</b> the page')")
        self.wish("light", intensity=0.75, hold_s=0)
        self.until("labPage.stream.topics.get('light').manual"
                   " && Math.abs(labPage.stream.topics.get('light').mean - 0.75) < 0.01")
        self.wish("release_light")
        self.until("!labPage.stream.topics.get('light').manual")
        self.wish("end", why="seen enough")
        self.says("banner", "the run has ended")
        self.assertEqual(0, self.lab.process.wait(30))
        self.assertEqual([], self.console())

    def console(self):
        return [entry for entry in browser.get_log("browser")
                if not any(word in entry["message"] for word in LOST_SERVER)]

    def wish(self, name, **fields):
        token = self.address.split("#token=")[1]
        request = urllib.request.Request(
            f"http://127.0.0.1:{PORT}/api/wish", json.dumps({"wish": name, **fields}).encode(),
            {"X-Lab-Token": token, "Content-Type": "application/json"})
        self.assertEqual(202, urllib.request.urlopen(request, timeout=5).status)


if __name__ == "__main__":
    ARGUMENTS = [pathlib.Path(argument).resolve() for argument in sys.argv[1:3]]
    unittest.main(argv=sys.argv[:1], verbosity=2)
