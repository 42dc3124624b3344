"""The page in a browser, against mock_lab.py: lost connections, recorded and past runs."""

import time

import mock_topics
from page_case import Keys, PageTest, browser, main


class Connection(PageTest):
    server_goes = True

    def test_connects_again_after_a_restart_of_the_server(self):
        self.open(robots=5)
        self.live()
        browser.execute_script("window.notReloaded = true")
        self.lab.stop_serving()
        self.says("banner", "no message from the server since")
        self.press(Keys.SPACE)
        self.says("stop-missing", "STOP NOT SENT")
        frames = self.js("labPage.view.arena.frames")
        self.lab.serve()
        self.until("document.getElementById('banner').hidden")
        self.until(f"labPage.view.arena.frames > {frames + 10}")
        self.assertTrue(self.js("window.notReloaded"))
        self.until("labPage.controls.stopText.startsWith('stopped: all 5')")
        self.assertEqual("", self.text("stop-missing"))

    def test_still_shows_after_a_reconnect_that_a_stop_was_not_sent(self):
        self.open(robots=5)
        self.live()
        self.lab.stop_serving()
        self.press(Keys.SPACE)
        self.says("stop-missing", "STOP NOT SENT")
        time.sleep(13)
        before = len(self.asked("/api/me"))
        self.lab.serve()
        self.comes(before + 1, lambda: self.asked("/api/me"))
        time.sleep(1)
        self.assertEqual([], self.sent_requests("stop"), "an old stop is not sent later")
        self.assertIn("STOP NOT SENT", self.text("stop-missing"))

    def test_closes_a_connection_without_data(self):
        self.open(robots=5)
        self.live()
        self.lab.mute = True
        self.until("labPage.stream.attempts > 0", 12)
        self.assertIn("no message from the server", self.text("banner"))
        self.lab.mute = False
        self.until("document.getElementById('banner').hidden")

    def test_shows_that_the_bus_is_silent(self):
        self.open(robots=5)
        self.live()
        self.lab.silent = True
        self.says("banner", "no message from the lab for")
        self.lab.silent = False
        self.until("document.getElementById('banner').hidden")
        self.assertEqual(0, self.js("labPage.stream.attempts"))

    def test_a_hidden_page_closes_its_connection(self):
        self.open(robots=5)
        self.live()
        browser.execute_script("""labPage.stream.hiddenTimeout = 100;
            Object.defineProperty(document, 'hidden', {configurable: true, get: () => true});
            document.dispatchEvent(new Event('visibilitychange'));""")
        self.until("labPage.stream.attempts === 1 && !labPage.stream.connected")
        time.sleep(2)
        self.assertFalse(self.js("labPage.stream.connected"))
        browser.execute_script("delete document.hidden;"
                               "document.dispatchEvent(new Event('visibilitychange'))")
        self.until("labPage.stream.connected")

    def test_a_slow_page_skips_to_the_newest_state(self):
        self.open(robots=20)
        self.live()
        before, ticks = self.js("labPage.view.arena.frames"), self.lab.world.ticks
        browser.execute_script("const end = performance.now() + 3000;"
                               "while (performance.now() < end);")
        missed, newest = self.lab.world.ticks - ticks, self.lab.world.frame()["t_us"]
        self.until(f"labPage.stream.topics.get('frame').t_us >= {newest}")
        shown = self.js("labPage.view.arena.frames") - before
        print(f"{missed} frames arrived while the page was blocked, it used {shown} of them")
        self.assertLess(shown, missed / 2)

    def test_the_token_leaves_the_address_bar_and_stays_valid(self):
        self.open(robots=2)
        self.live()
        address = browser.current_url
        self.assertNotIn("token", address)
        self.assertNotIn("#", address)
        browser.refresh()
        self.live()
        self.assertEqual(address, browser.current_url)
        self.js("location.hash = 'token=another'")
        self.until("!location.hash && sessionStorage.getItem('lab-token') === 'another'")


class Replay(PageTest):
    def test_plays_a_recorded_run_without_commands_to_robots(self):
        self.open(robots=3, replay=True)
        self.live()
        self.until("!document.getElementById('player').hidden && labPage.controls.control")
        self.assertTrue(self.js("document.getElementById('stop').disabled"))
        self.assertIn("recorded", self.text("read-only"))
        browser.execute_script("const s = document.getElementById('player-at'); s.value = 100;"
                               "s.dispatchEvent(new Event('change'))")
        self.says("player-text", "1:4")
        self.assertEqual([{"request": "seek", "to_s": 100}], self.sent_requests("seek"))
        browser.execute_script("document.getElementById('player-go').click()")
        self.says("player-go", "play")
        self.press(Keys.SPACE)
        self.says("stop-missing", "recorded run")
        self.assertEqual([], self.sent_requests("stop"))

    def test_shows_the_film_of_a_recorded_run_at_the_slider(self):
        self.open(robots=3, replay=True)
        self.live()
        self.until("!document.getElementById('player-film').hidden")
        browser.execute_script("const s = document.getElementById('player-at'); s.value = 101;"
                               "s.dispatchEvent(new Event('input'))")
        self.says("player-film-text", "film at 1:40")
        self.until("document.getElementById('player-film-video').src.startsWith('blob:')")
        self.lab.world.replay = False
        self.lab.publish("lab", dict(self.lab.world.lab(), run="live"))
        self.until("document.getElementById('player-film').hidden")

    def test_a_jump_in_a_recorded_run_removes_the_curves(self):
        self.server_refuses = True
        self.open(robots=3, replay=True, size=(1280, 2200))
        self.live()
        self.until("labPage.charts.msd.pointsDrawn() === 72"
                   " && labPage.charts.runtimes.pointsDrawn() > 0")
        self.lab.pools = 0
        time.sleep(1.2)
        self.lab.take_request({"request": "seek", "to_s": 100})
        self.until("labPage.charts.msd.pointsDrawn() === 0"
                   " && labPage.charts.runtimes.pointsDrawn() === 0"
                   " && labPage.stream.all('history/').length === 0")
        self.lab.world.take_request = lambda _: "refused: not now"
        browser.execute_script("document.getElementById('player-go').click()")
        self.says("player-say", "pause: refused: not now")
        self.lab.world.replay = False
        self.lab.publish("lab", dict(self.lab.world.lab(), run="live"))
        self.until("document.getElementById('player').hidden")
        self.until("!document.getElementById('stop').disabled")


class NoLab(PageTest):
    def test_says_that_no_lab_is_running(self):
        self.open(lab=False)
        self.until("document.body.classList.contains('no-lab')")
        self.says("link-text", "no lab is running")
        self.assertEqual("quiet", self.js("document.getElementById('link-lamp').dataset.state"))
        self.says("labs-text", "no lab is running: start an experiment below, or with lab run FILE")
        self.assertFalse(self.js("!!document.querySelector('#labs li')"))

    def test_lists_running_labs_at_the_top(self):
        self.open(lab=False)
        address = "http://127.0.0.1:8481/#token=0"
        self.lab.labs = [{"name": "abp-1", "directory": "/runs/abp-1", "replay": False,
                          "address": address},
                         {"name": "log-2", "directory": "/runs/log-2", "replay": True,
                          "address": None}]
        self.until("document.querySelectorAll('#labs li').length === 2")
        self.assertEqual(address, self.js("document.querySelector('#labs a').href"))
        self.assertEqual("abp-1 its page", self.js("document.querySelector('#labs li').textContent"))
        self.assertIn("log-2 (a recorded run) without a page", self.text("labs"))
        self.assertEqual("running: 2", self.text("labs-text"))
        above = self.js("""[...document.querySelectorAll('main > *')].every((other) =>
            other.id === 'labs-section' || !other.offsetParent || other.offsetTop >
            document.getElementById('labs-section').offsetTop)""")
        self.assertTrue(above, "the running labs are not at the top")

    def test_lists_a_run_in_virtual_time_that_was_started_here(self):
        self.open(lab=False)
        self.lab.started = {"state": "running", "code": None, "output": "", "address": None,
                            "run": "swarm-3"}
        self.says("labs", "swarm-3 (started here)")

    def test_the_list_is_not_shown_beside_a_lab(self):
        self.open(robots=2)
        self.live()
        self.assertEqual("live", self.text("link-text"))
        self.assertEqual("none", self.js(
            "getComputedStyle(document.getElementById('labs-section')).display"))


class PastRuns(PageTest):
    def test_says_how_many_runs_can_be_compared(self):
        self.open(robots=2, size=(1280, 4000))
        self.until("document.querySelectorAll('#runs tbody tr').length === 3")
        said = [self.text("compare-text")]
        for box in range(3):
            browser.execute_script(
                f"document.querySelectorAll('#runs input')[{box}].click()")
            said.append(self.text("compare-text"))
        self.assertEqual(["", "1 selected, 2 can be compared: select one more", "",
                          "3 selected, 2 can be compared: clear 1"], said)
        self.assertTrue(self.js("document.getElementById('runs-compare').disabled"))
        browser.execute_script("document.querySelector('#runs input').click()")
        self.assertEqual("", self.text("compare-text"))
        self.assertFalse(self.js("document.getElementById('runs-compare').disabled"))

    def test_lists_campaigns_with_their_progress(self):
        self.open(robots=2, size=(1280, 4000))
        self.until("document.querySelectorAll('#campaigns tbody tr').length === 2")
        text = self.text("campaigns")
        self.assertIn("12 of 30", text)
        self.assertIn("on the lab", text)
        self.assertEqual(self.js("document.querySelector('#campaigns progress').value"), 12)
        self.assertTrue(self.js("document.querySelector('#campaigns a').href").endswith(
            "/api/campaigns/night-20260104T200000Z/index.html"))
        self.assertEqual(self.js("document.querySelectorAll('#campaigns a').length"), 1)

    def test_lists_runs_and_compares_two(self):
        self.open(robots=2, size=(1280, 4000))
        self.until("document.querySelectorAll('#runs tbody tr').length === 3")
        link = self.js("document.querySelector('#runs a').outerHTML")
        self.assertIn('rel="noopener"', link)
        self.assertTrue(self.js("document.querySelectorAll('#runs img')[1].src"
                                ".endsWith('/figures/trajectory%20abp.svg')"))
        self.assertIn("summary.json is cut short", self.text("runs"))
        self.assertTrue(self.js("document.getElementById('runs-compare').disabled"))
        browser.execute_script("[...document.querySelectorAll('#runs input')].slice(0, 2)"
                               ".forEach((box) => box.click())")
        browser.execute_script("document.getElementById('runs-compare').click()")
        self.until("labPage.charts.compare.pointsDrawn() === 48")

    def test_lists_the_runs_after_one_with_a_verdict_that_is_no_verdict(self):
        # Each object of JavaScript has these names.
        names = ["constructor", "toString", "__proto__", "agrees"]
        self.open(robots=2, size=(1280, 4000))
        runs = [dict(mock_topics.RUNS[0], name=f"run-{name}",
                     verdicts=[{"program": "abp", "verdict": name, "max_z": 1.9}])
                for name in names]
        self.until("document.querySelectorAll('#runs tbody tr').length === 3")
        self.lab.world.runs = lambda: runs
        browser.execute_script("document.getElementById('runs-refresh').click()")
        self.until("document.querySelectorAll('#runs tbody tr').length === 4")
        for name in names:
            self.assertIn(f"abp: {name} (max |z| 1.9)", self.text("runs"))
        self.assertEqual(["agrees"], self.js(
            "[...document.querySelectorAll('#runs .good')].map((one) => one.textContent)"))

    def test_checks_and_starts_an_experiment(self):
        self.open(robots=2, size=(1280, 4000))
        self.live()
        self.until("document.querySelectorAll('#start-file option').length === 2"
                   " && !document.getElementById('start-go').disabled")
        browser.execute_script("document.getElementById('start-set').value = 'nonsense'")
        browser.execute_script("document.getElementById('start-go').click()")
        self.says("start-output", "--set nonsense: expected key=value")
        self.assertEqual([], [p for _, p in self.lab.requests if p == "/api/start"])
        browser.execute_script("document.getElementById('start-set').value = 'duration_s=60\\n'")
        browser.execute_script("document.getElementById('start-go').click()")
        self.until("document.querySelector('#start-link a')?.href.includes('#token=')")


if __name__ == "__main__":
    main()
