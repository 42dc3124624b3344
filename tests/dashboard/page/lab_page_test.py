"""Tests the page in a browser with a real lab: twenty simulated robots, all services as processes.

  tests/in_private_network.sh /usr/bin/python3 tests/dashboard/page/lab_page_test.py FOLDER_OF_PROGRAMS EXPERIMENTS

Exit status 77: chromium or selenium is missing. With LAB_LONG=1 the bus is silent for 30 s, else 6 s,
and delays are limited, which other work on the machine would change.
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
QUIET = "LAB_LONG" in os.environ  # runs alone: delays are those of the lab
SILENCE_S = 30 if QUIET else 6
MAX_STOP_MS = 200  # until every robot has confirmed a stop
# Two poses of a resting robot differ by the tracker's noise, 0.04 cm in each direction. A moving robot
# covers ten times as much in 1.5 s.
MOVED_CM = 0.3


class Lab:
    """The process `lab run --web` and its children."""

    def __init__(self, programs, experiments, folder, name="swarm", *more):
        self.folder = pathlib.Path(folder)
        environment = dict(os.environ, XDG_RUNTIME_DIR=folder)
        self.output = open(self.folder / "output", "w+", encoding="utf-8")
        self.process = subprocess.Popen(
            [programs / "lab", "run", experiments / f"{name}.toml", "--web", "--no-report",
             "--out", self.folder / "runs", "--set", f"dashboard.port={PORT}", *more],
            stdout=self.output, stderr=subprocess.STDOUT, env=environment)

    def printed(self):
        return (self.folder / "output").read_text(encoding="utf-8")

    def address(self):
        end = time.monotonic() + 60
        while time.monotonic() < end and self.process.poll() is None:
            found = re.search(r"web\s+(http://\S+#token=\S+)", self.printed())
            if found:
                return found[1]
            time.sleep(0.05)
        raise AssertionError("no address in: " + self.printed())

    def children(self):
        """Process ids by name of the executable."""
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
            return self.process.wait(60)
        finally:
            self.process.kill()
            self.process.wait()
            self.output.close()


class WithALab(PageTest):
    server_goes = True
    token = True

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.lab = Lab(*ARGUMENTS, folder.name)
        self.addCleanup(self.lab.end)
        self.address = self.lab.address()
        self.addCleanup(browser.get, "about:blank")
        # High enough for the curves to be visible, because invisible ones are not drawn.
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": 1280, "height": 2200, "deviceScaleFactor": 1, "mobile": False})
        browser.get_log("browser")
        browser.get(self.address)
        # Measures in the page when the first analysis arrives and when the first curve is drawn.
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

    def moved(self, before):
        after = self.robots()
        return [i for i in after
                if i in before and math.hypot(after[i]["x"] - before[i]["x"],
                                              after[i]["y"] - before[i]["y"]) > MOVED_CM]

    def most_move(self):
        """Waits until more than ten robots have moved."""
        before, end = self.robots(), time.monotonic() + 60
        while len(self.moved(before)) <= 10:
            self.assertLess(time.monotonic(), end, "robots do not move")
            time.sleep(0.1)

    def test_shows_and_stops_a_lab_also_after_a_reload(self):
        self.until("labPage.robots().length === 20")
        self.most_move()

        self.until("seen.curve")
        after = self.js("seen.curve - seen.analysis")
        print(f"the MSD is drawn {after:.0f} ms after the first ANALYSIS")
        if QUIET:
            self.assertLess(after, 2000)

        self.press(Keys.SPACE)
        self.until("labPage.controls.stopText.startsWith('stopped: all 20 robots')")
        took = self.js("labPage.stream.topics.get('stop').took_ms")
        print(f"STOP reached all 20 robots in {took:.0f} ms; the page: {self.text('stop-state')}")
        if QUIET:
            self.assertLess(took, MAX_STOP_MS)
        self.until("labPage.stream.topics.get('robots').every(robot => robot.stopped)")
        time.sleep(0.5)
        before = self.robots()
        time.sleep(1.5)
        self.assertEqual([], self.moved(before))

        browser.refresh()
        self.live()
        self.until("labPage.controls.stopText.startsWith('stopped: all 20 robots')")
        self.assertTrue(self.js("labPage.controls.control"))

        self.send_request("release_stop")
        self.until("labPage.stream.topics.get('stop').state === 'free'")
        self.most_move()
        self.assertEqual([], self.console())

    def test_continues_after_the_server_is_killed_and_restarted(self):
        browser.execute_script("window.notReloaded = true")
        server = self.lab.children()["dashboard"]
        os.kill(server, signal.SIGSTOP)
        self.says("banner", "no message from the server since")
        os.kill(server, signal.SIGKILL)
        self.until("document.getElementById('banner').hidden")
        self.until("labPage.robots().length === 20")
        self.assertTrue(self.js("window.notReloaded"))
        self.press(Keys.SPACE)  # the token is still valid
        self.until("labPage.controls.stopText.startsWith('stopped: all 20 robots')")
        self.assertEqual([], self.console())

    def test_waits_for_a_silent_lab(self):
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
        self.until("document.getElementById('banner').hidden")
        self.until("labPage.robots().length === 20")
        self.assertEqual([], self.console())

    def test_clients_that_do_not_read_do_not_slow_down_others(self):
        slow = [socket.create_connection(("127.0.0.1", PORT)) for _ in range(5)]
        for client in slow:
            self.addCleanup(client.close)
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            client.sendall(b"GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % PORT)
        time.sleep(5)
        frames, begin = self.js("labPage.view.arena.frames"), time.monotonic()
        self.until(f"labPage.view.arena.frames > {frames + 20}")
        took = time.monotonic() - begin
        print(f"beside five clients that do not read: {20 / took:.0f} frames per second")
        if QUIET:
            self.assertLess(took, 2)
        self.until("labPage.stream.topics.get('health').server.viewers >= 1")

    def test_pauses_marks_and_ends_a_script(self):
        self.until("labPage.stream.topics.get('script')?.phase === 'script'")
        self.send_request("pause")
        self.until("labPage.stream.topics.get('script').phase === 'paused'")
        self.send_request("resume")
        self.until("labPage.stream.topics.get('script').phase === 'script'")
        self.send_request("mark", text="seen <b>by</b> the page")
        self.until("labPage.stream.topics.get('timeline').marks"
                   ".some(mark => mark.text === 'dashboard: seen <b>by</b> the page')")
        self.send_request("light", intensity=0.75, hold_s=0)
        self.until("labPage.stream.topics.get('light').manual"
                   " && Math.abs(labPage.stream.topics.get('light').mean - 0.75) < 0.01")
        self.send_request("release_light")
        self.until("!labPage.stream.topics.get('light').manual")
        self.send_request("end", why="seen enough")
        self.says("banner", "the run has ended")
        self.assertEqual(0, self.lab.process.wait(60))
        self.assertEqual([], self.console())

    def console(self):
        return [entry for entry in browser.get_log("browser")
                if not any(word in entry["message"] for word in LOST_SERVER)]

    def send_request(self, name, **fields):
        token = self.address.split("#token=")[1]
        request = urllib.request.Request(
            f"http://127.0.0.1:{PORT}/api/request", json.dumps({"request": name, **fields}).encode(),
            {"X-Lab-Token": token, "Content-Type": "application/json"})
        self.assertEqual(202, urllib.request.urlopen(request, timeout=60).status)


if __name__ == "__main__":
    ARGUMENTS = [pathlib.Path(argument).resolve() for argument in sys.argv[1:3]]
    unittest.main(argv=sys.argv[:1], verbosity=2)
