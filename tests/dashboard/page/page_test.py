"""The dashboard's page in a browser, against mock_lab.py: what is the page's own doing.

  python3 tests/dashboard/page/page_test.py      (77: no chromium or no selenium here)
"""

import csv
import io
import json
import os
import pathlib
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree

sys.dont_write_bytecode = True
try:
    from selenium import webdriver
    from selenium.common.exceptions import WebDriverException
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    print("page_test: no selenium (Debian: python3-selenium)")
    sys.exit(77)

from mock_lab import MockLab, TOKEN

CHROMEDRIVER = pathlib.Path("/usr/bin/chromedriver")
REFUSED = "the server responded with a status of"
LOST_SERVER = ("ERR_CONNECTION_REFUSED", "ERR_INCOMPLETE_CHUNKED_ENCODING", "ERR_CONNECTION_RESET",
               "ERR_EMPTY_RESPONSE", "ERR_NETWORK_IO_SUSPENDED", "ERR_SOCKET_NOT_CONNECTED")


def new_browser():
    options = webdriver.ChromeOptions()
    for argument in ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage",
                     "--disable-background-networking",
                     "--window-size=1280,1000"]:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(str(CHROMEDRIVER)), options=options)


def processor_time():
    """[s] of the browser and all its processes."""
    parents, spent = {}, {}
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        parents[int(entry.name)] = int(fields[1])
        spent[int(entry.name)] = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def ours(process):
        while process in parents and process != browser.service.process.pid:
            process = parents[process]
        return process in parents

    return sum(time for process, time in spent.items() if ours(process))


def setUpModule():
    global browser
    browser = new_browser()


def tearDownModule():
    browser.quit()


class PageTest(unittest.TestCase):
    """Each test has a lab of its own and ends with a look at the console."""

    server_goes = False  # then the browser itself writes that it is not there
    server_refuses = False  # then it writes that too

    def open(self, token=True, size=(1280, 1000), **lab):
        self.lab = MockLab(**lab).serve()
        self.token = token
        self.addCleanup(self.lab.close)
        self.addCleanup(browser.get, "about:blank")
        self.addCleanup(self.look_at_console)
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size[0] < 600})
        browser.get_log("browser")
        browser.get(self.lab.address_with_token if token else self.lab.address)

    def look_at_console(self):
        log = browser.get_log("browser")
        if self.server_goes:
            log = [entry for entry in log
                   if not any(word in entry["message"] for word in LOST_SERVER)]
        if self.server_refuses:
            log = [entry for entry in log if REFUSED not in entry["message"]]
        self.assertEqual([], log, "the console is not empty")

    def js(self, text, *arguments):
        return browser.execute_script("return " + text, *arguments)

    def until(self, text, patience=10.0):
        """Waits until the JavaScript expression is true; returns its value."""
        end = time.monotonic() + patience
        while True:
            try:
                value = self.js(text)
            except WebDriverException:
                value = None  # the page is still loading
            if value:
                return value
            self.assertLess(time.monotonic(), end, f"not in {patience} s: {text}")
            time.sleep(0.05)

    def live(self):
        self.until("window.labPage && labPage.robots().length > 0"
                   " && labPage.stream.topics.has('stop')"
                   f" && document.body.dataset.control === '{str(self.token).lower()}'")

    def text(self, identity):
        return self.js("document.getElementById(arguments[0]).textContent", identity)

    def says(self, identity, words):
        """Waits until the element's text holds the words."""
        self.until(f"document.getElementById('{identity}').textContent"
                   f".includes({json.dumps(words)})")

    def press(self, *keys):
        browser.switch_to.active_element.send_keys(*keys)

    def wishes(self, name):
        return [body for _, body in self.lab.wishes if body["wish"] == name]

    def comes(self, count, found):
        """Waits until there are so many."""
        end = time.monotonic() + 8
        while len(found()) < count:
            self.assertLess(time.monotonic(), end, "it did not come")
            time.sleep(0.02)

    def asked(self, path):
        return [one for _, one in self.lab.requests if one == path]


class Live(PageTest):
    def test_twenty_robots_are_shown_and_move(self):
        self.open(robots=20)
        self.live()
        before = {r["id"]: r for r in self.js("labPage.robots()")}
        time.sleep(1.5)
        after = {r["id"]: r for r in self.js("labPage.robots()")}
        self.assertEqual(sorted(after), list(range(1, 21)))
        still = [i for i in after
                 if (after[i]["x"], after[i]["y"]) == (before[i]["x"], before[i]["y"])]
        self.assertEqual([], still)

    def test_a_picture_shows_robots_where_they_are(self):
        self.open(robots=3)
        self.live()
        browser.execute_script("document.getElementById('show-trails').click()")
        self.js("labPage.controls.stop('test')")
        self.until("labPage.controls.stopText.startsWith('stopped')")
        time.sleep(0.5)
        painted = self.js("""(canvas => {
            const [width, height] = [canvas.width, canvas.height];
            const all = canvas.getContext('2d').getImageData(0, 0, width, height).data;
            const scale = Math.min(width / 126, height / 96); // the arena and 3 cm around it
            return labPage.robots().map(({x, y, angle}) => { // behind the letter, not on the nose
                const column = Math.round(width / 2 + (x - 2.8 * Math.cos(angle) - 60) * scale);
                const row = Math.round(height / 2 - (y - 2.8 * Math.sin(angle) - 45) * scale);
                return [...all.slice(4 * (row * width + column), 4 * (row * width + column) + 4)];
            });
        })(document.getElementById('arena-over'))""")
        self.assertEqual([[213, 94, 0, 255], [0, 158, 115, 255], [0, 114, 178, 255]], painted)

    def test_a_hundred_robots_leave_room_for_30_pictures_a_second(self):
        # In processor time of all the browser's processes, which does not ask what else the machine
        # does: what a second costs without the arena, and a picture of the arena.
        self.open(robots=100)
        self.live()
        time.sleep(3)
        with_arena, pictures = self.three_seconds()
        browser.execute_script("document.getElementById('runs-section').scrollIntoView()")
        time.sleep(1)
        without_arena, none = self.three_seconds()
        self.assertEqual(0, none)
        picture = max(0, with_arena - without_arena) / pictures
        print(f"100 robots: {1e3 * picture:.1f} ms of processor time a picture, "
              f"{1e3 * without_arena / 3:.0f} ms a "
              f"second without the arena; {pictures / 3:.0f} pictures a second")
        self.assertLess(30 * picture + without_arena / 3, 1)

    def three_seconds(self):
        """@return (processor time, pictures)"""
        spent, pictures = processor_time(), self.js("labPage.view.pictures")
        time.sleep(3)
        return processor_time() - spent, self.js("labPage.view.pictures") - pictures

    def test_the_first_analysis_is_enough_for_curves(self):
        self.open(robots=20, size=(1280, 2200), pools=0)
        self.live()
        self.assertEqual(0, self.js("labPage.charts.msd.pointsDrawn()"))
        self.lab.pools = 1
        self.until("labPage.stream.topics.has('pool/abp')")
        begin = time.monotonic()
        for chart in ["msd", "angular_msd", "C_l", "runtimes"]:
            self.until(f"labPage.charts.{chart}.pointsDrawn() > 10")
        print(f"curves stand {time.monotonic() - begin:.2f} s after the first analysis")
        self.until("document.querySelectorAll('#estimates tbody tr').length === 9")
        self.assertEqual(9, self.js("document.querySelectorAll('#chart-msd > svg .hollow').length"))

    def test_one_robot_alone_and_fewer_programs(self):
        self.open(robots=6, size=(1280, 2200))
        self.live()
        self.until("labPage.charts.msd.pointsDrawn() === 72")
        browser.execute_script("document.querySelector('#curves-programs input').click()")
        self.until("labPage.charts.msd.pointsDrawn() === 48")
        browser.execute_script("const s = document.getElementById('curves-source'); s.value = '4';"
                               "s.dispatchEvent(new Event('change'))")
        self.until("labPage.charts.msd.pointsDrawn() === 24")

    def test_foreign_text_stays_text(self):
        self.open(robots=2)
        self.lab.world.life = 61.0
        self.live()
        self.says("script-now", "half <b>light</b>")
        self.assertEqual(0, self.js("document.querySelectorAll('main b, main i').length"))

    def test_missing_topics_and_nulls_break_nothing(self):
        self.open(robots=2, lab=False)
        self.until("window.labPage && document.body.classList.contains('no-lab')")
        for topic, value in [("pool/x", {"program": "x", "curves": None, "estimates": None}),
                             ("health", {}),
                             ("robots", []), ("frame", {"t_us": 1, "robots": [],
                                                        "unidentified": []}),
                             ("script", {"phase": "preparing", "left_s": None, "step": -1,
                                         "label": ""}),
                             ("timeline", {"start_us": None, "steps": [], "marks": [], "faults": [],
                                           "end": None}),
                             ("history/x", {"program": "x", "t_s": [], "estimates": []}),
                             ("light", {"version": 1, "columns": 0, "rows": 0, "mean": None,
                                        "label": None}),
                             ("stop", {"state": "free", "total": 0, "confirmed": 0,
                                       "unconfirmed": []}),
                             ("camera", {"state": "waiting", "picture": False}),
                             ("nobody knows this", None),
                             ("runtimes/x", {"program": "x", "gamma_per_s": None, "edges_s": [],
                                             "counts": []})]:
            self.lab.publish(topic, value)
        self.until("labPage.stream.topics.has('runtimes/x')")
        time.sleep(0.5)

    def test_past_the_end(self):
        self.open(robots=2)
        self.live()
        self.lab.wish({"wish": "end"})
        self.says("banner", "the run has ended: ended by dashboard")
        self.server_goes = True  # as it does after a run: that is no fault to be told
        self.lab.stop_serving()
        time.sleep(4)
        self.assertIn("the run has ended", self.text("banner"))

    def test_another_run_leaves_nothing_of_the_one_before(self):
        self.open(robots=4, size=(1280, 2200))
        self.live()
        self.until("labPage.charts.msd.pointsDrawn() > 10")
        self.lab.pools = 0
        time.sleep(1.2)
        self.lab.publish("lab", dict(self.lab.world.lab(), run="another"))
        self.until("labPage.charts.msd.pointsDrawn() === 0")
        self.says("run-name", "another")

    def test_what_is_gone_is_forgotten(self):
        self.open(robots=4, size=(1280, 2200))
        self.live()
        self.until("labPage.charts.msd.pointsDrawn() === 72")
        self.lab.pools = 0
        time.sleep(1.2)
        self.lab.publish("pool/abp", None)
        self.until("labPage.charts.msd.pointsDrawn() === 48")
        self.lab.publish("history/abp", None)
        self.until("!labPage.stream.topics.has('history/abp')")
        for topic in ["stop", "light", "timeline", "delivery", "camera", "robots", "health"]:
            self.lab.publish(topic, None)  # and told anew within a second: nothing breaks
        time.sleep(1.5)
        self.until("labPage.stream.topics.has('robots')")

    def test_light_that_was_not_told_is_asked_for_again(self):
        self.server_refuses = True
        self.open(robots=2)
        self.lab.broken.add("/api/light")
        each = self.lab.world.each_second
        self.lab.world.each_second = lambda pools: [one for one in each(pools) if one[0] != "light"]
        time.sleep(1)
        self.lab.publish("light", dict(self.lab.world.light(), version=7))  # and no more of it
        self.lab.requests.clear()
        self.comes(2, lambda: self.asked("/api/light"))
        self.lab.broken.clear()
        before = len(self.asked("/api/light"))
        time.sleep(3)
        self.assertEqual(before + 1, len(self.asked("/api/light")), "it was told: no more of it")
        shade = self.js("((c) => c.getContext('2d').getImageData(c.width / 2, c.height / 2, 1, 1)"
                        ".data[0])(document.getElementById('arena-under'))")
        self.assertGreater(shade, 150, "the lit middle")

    def test_what_is_left_out_is_counted(self):
        self.open(robots=2, size=(1280, 6000))
        world = self.lab.world
        timeline, health = world.timeline, world.health
        world.timeline = lambda: dict(timeline(), steps_before=12, marks_before=3, faults_before=4)
        world.health = lambda: dict(health(), streams_left_out=5)
        self.live()
        self.says("timeline-more", "12 earlier steps, 7 earlier marks and faults")
        self.says("streams-more", "5 more streams")


class Keyboard(PageTest):
    def test_space_stops_all_robots_and_the_page_says_so(self):
        self.open(robots=20)
        self.live()
        browser.find_element(By.TAG_NAME, "body").send_keys(Keys.SPACE)
        self.until("labPage.controls.stopText === 'stopped: all 20 robots, 84 ms, by dashboard'")
        self.assertEqual(1, len(self.wishes("stop")))
        flags = {r[5] for r in self.js("labPage.stream.topics.get('frame').robots")}
        self.assertEqual({2}, flags)
        browser.find_element(By.TAG_NAME, "body").send_keys(Keys.SPACE)  # again: it is still so
        self.until("labPage.controls.stopText === 'stopped: all 20 robots, 84 ms, by dashboard'")
        self.assertEqual("", self.text("stop-missing"))

    def test_a_stop_is_sent_before_the_server_says_who_may_do_what(self):
        self.server_refuses = True
        self.open(robots=3)
        self.lab.broken.add("/api/me")
        browser.refresh()
        self.says("read-only", "not now")
        self.assertEqual("null", self.js("document.body.dataset.control"))
        self.assertFalse(self.js("document.getElementById('stop').disabled"))
        browser.find_element(By.TAG_NAME, "body").send_keys(Keys.SPACE)
        self.until("labPage.controls.stopText.startsWith('stopped: all 3')")
        self.lab.broken.clear()
        self.until("labPage.controls.control === true")
        self.lab.broken.add("/api/me")
        before = len(self.asked("/api/me"))
        self.js("labPage.stream.makeRoom()")
        self.comes(before + 2, lambda: self.asked("/api/me"))
        self.assertTrue(self.js("labPage.controls.control"), "it was once so and nobody denied it")

    def test_a_stop_needs_no_free_connection(self):
        self.open(robots=3)
        self.live()
        browser.execute_script("for (let i = 0; i < 5; ++i) fetch(`/api/stream?${i}`)"
                               ".then((stream) => stream.text()).catch(() => {})")
        time.sleep(1)
        self.press(Keys.SPACE)
        self.comes(1, lambda: self.wishes("stop"))

    def test_a_stop_is_sent_until_it_is_taken_or_released(self):
        self.server_refuses = True
        self.open(robots=3)
        self.live()
        take, self.lab.world.wish = self.lab.world.wish, lambda _: "refused: not yet"
        self.press(Keys.SPACE)
        self.says("stop-missing", "STOP NOT SENT: refused: not yet")
        self.comes(3, lambda: self.wishes("stop"))
        self.lab.world.wish = take
        self.until("labPage.controls.stopText.startsWith('stopped: all 3')")
        self.assertEqual("", self.text("stop-missing"))
        sent = len(self.wishes("stop"))
        time.sleep(1)
        self.assertEqual(sent, len(self.wishes("stop")))

        self.lab.world.wish = lambda _: "refused: not yet"
        self.press(Keys.SPACE)
        self.says("stop-missing", "STOP NOT SENT")
        browser.execute_script("document.querySelector('#release-place > button').click();"
                               "document.querySelector('#release-place span button').click()")
        self.comes(1, lambda: self.wishes("release_stop"))
        time.sleep(0.5)
        sent = len(self.wishes("stop"))
        time.sleep(1.5)
        self.assertEqual(sent, len(self.wishes("stop")))

    def test_who_does_not_stop_is_named(self):
        self.open(robots=20)
        self.lab.world.deaf = [3, 7]
        self.live()
        self.press(Keys.SPACE)
        self.says("stop-missing", "NOT confirmed: 3, 7")
        self.assertIn("18 of 20 confirmed", self.text("stop-state"))

    def test_space_on_a_button_stops_and_does_not_press_it(self):
        self.open(robots=2)
        self.live()
        for identity in ["pause", "follow", "show-trails", "light-hold", "light-level"]:
            before = len(self.wishes("stop"))
            browser.execute_script("document.getElementById(arguments[0]).focus()", identity)
            self.press(Keys.SPACE)
            end = time.monotonic() + 5
            while len(self.wishes("stop")) == before and time.monotonic() < end:
                time.sleep(0.02)
            self.assertEqual(before + 1, len(self.wishes("stop")), identity)
        self.assertEqual([], self.wishes("pause"))
        self.assertTrue(self.js("document.getElementById('show-trails').checked"))

    def test_space_in_a_text_field_is_a_space_and_escape_leaves_it(self):
        self.open(robots=2)
        self.live()
        browser.execute_script("document.getElementById('mark-text').focus()")
        self.press("a b")
        self.assertEqual("a b", self.js("document.getElementById('mark-text').value"))
        self.press(Keys.ENTER)
        self.says("events", "dashboard: a b")
        self.assertEqual([], self.wishes("stop"))
        self.press(Keys.ESCAPE)
        self.assertEqual("BODY", self.js("document.activeElement.tagName"))

    def test_stop_comes_first_and_everything_has_a_name(self):
        self.open(robots=2)
        self.live()
        self.press(Keys.TAB)
        self.assertEqual("stop", self.js("document.activeElement.id"))
        self.assertNotEqual("none",
                            self.js("getComputedStyle(document.activeElement).outlineStyle"))
        seen = []
        for _ in range(25):
            self.press(Keys.TAB)
            seen.append(self.js("document.activeElement.id || document.activeElement.textContent"))
        self.assertIn("arena", seen)
        self.assertLess(seen.index("arena"), seen.index("pause"))
        nameless = self.js("""[...document.querySelectorAll('button, input, select, textarea')]
            .filter(e => !(e.textContent.trim() && e.tagName === 'BUTTON'))
            .filter(e => !e.labels?.length && !e.ariaLabel)
            .map(e => e.outerHTML)""")
        self.assertEqual([], nameless)

    def test_release_and_end_ask_again(self):
        self.open(robots=2)
        self.live()
        self.press(Keys.SPACE)
        self.until("labPage.controls.stopText.startsWith('stopped')")
        for place, wish in [("release-place", "release_stop"), ("end-place", "end")]:
            browser.execute_script("document.querySelector('#' + arguments[0] + ' button').focus()",
                                   place)
            self.press(Keys.ENTER)
            self.assertEqual("no", self.js("document.activeElement.textContent"))
            self.assertEqual([], self.wishes(wish))
            browser.execute_script(f"document.querySelector('#{place} span button').focus()")
            self.press(Keys.ENTER)
            end = time.monotonic() + 5
            while not self.wishes(wish) and time.monotonic() < end:
                time.sleep(0.02)
            self.assertEqual(1, len(self.wishes(wish)))

    def test_robots_are_chosen_followed_and_looked_at_closely(self):
        self.open(robots=5)
        self.live()
        self.until("labPage.stream.topics.has('robots')")
        browser.execute_script("document.getElementById('arena').focus()")
        self.press(Keys.ARROW_RIGHT)
        self.press(Keys.ARROW_RIGHT)
        self.assertEqual(2, self.js("labPage.view.chosen"))
        self.press(Keys.ARROW_LEFT, "f")
        self.assertEqual([1, True], self.js("[labPage.view.chosen, labPage.view.following]"))
        self.says("robot-facts", "wheels3.10, 2.80 cm/s")
        self.says("robot-facts", "programrtp: v 3.00 cm/s")
        names = self.js("[...document.querySelectorAll('#robot-facts dt')].map(e => e.textContent)")
        self.assertEqual([], [name for name in names if "_" in name])
        zoom = self.js("labPage.view.zoom()")
        self.assertGreater(zoom, 1)
        self.press("-")
        self.assertLess(self.js("labPage.view.zoom()"), zoom)
        self.press("+", "+")
        self.assertGreater(self.js("labPage.view.zoom()"), zoom)
        self.press("0")
        self.assertEqual([1, False], self.js("[labPage.view.zoom(), labPage.view.following]"))
        self.press("?")
        self.assertTrue(self.js("document.getElementById('help').open"))
        browser.execute_script("document.querySelector('#help button').click()")
        self.assertFalse(self.js("document.getElementById('help').open"))

    def test_a_click_chooses_a_robot(self):
        self.open(robots=5)
        self.live()
        self.press(Keys.SPACE)
        self.until("labPage.controls.stopText.startsWith('stopped')")
        time.sleep(0.3)
        x, y = self.js("labPage.view.placeOf(3)")
        corner = self.js("(b => [b.left, b.top])"
                         "(document.getElementById('arena').getBoundingClientRect())")
        for kind in ["mousePressed", "mouseReleased"]:
            browser.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": kind, "x": corner[0] + x,
                                                                 "y": corner[1] + y,
                                                                 "button": "left", "clickCount": 1})
        self.assertEqual(3, self.js("labPage.view.chosen"))


class Rights(PageTest):
    def test_without_the_token_nothing_can_be_pressed_and_the_page_says_why(self):
        self.open(robots=2, token=False)
        browser.execute_script("sessionStorage.clear()")
        browser.refresh()
        self.live()
        self.says("read-only", "no token")
        self.assertTrue(self.js("document.getElementById('stop').disabled"))
        enabled = self.js("document.querySelectorAll('#controls :enabled').length")
        self.assertEqual(0, enabled)
        self.press(Keys.SPACE)
        self.says("stop-missing", "cannot stop the robots")
        self.assertEqual([], [path for kind, path in self.lab.requests if kind == "POST"])

    def test_the_token_is_in_no_request_line_and_survives_a_reload(self):
        self.open(robots=2)
        self.live()
        browser.refresh()
        self.live()
        self.until("labPage.controls.control")
        self.assertEqual([], [path for _, path in self.lab.requests if TOKEN in path])
        self.assertIn(TOKEN, browser.current_url)

    def test_a_refused_wish_is_told(self):
        self.server_goes = True
        self.open(robots=2)
        self.live()
        self.until("labPage.controls.control")
        self.lab.read_only = True
        browser.execute_script("document.getElementById('pause').click()")
        self.says("note", "pause: this page is read-only")
        browser.get_log("browser")  # the browser itself notes the 403


class Looks(PageTest):
    def ground(self):
        return self.js("getComputedStyle(document.body).backgroundColor")

    def test_light_and_dark_by_the_system_and_by_the_switch(self):
        self.open(robots=2)
        grounds = {}
        for scheme in ["light", "dark"]:
            browser.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                    {"features": [{"name": "prefers-color-scheme",
                                                   "value": scheme}]})
            self.live()
            grounds[scheme] = self.ground()
        self.assertEqual({"light": "rgb(243, 244, 245)", "dark": "rgb(20, 23, 27)"}, grounds)
        browser.execute_script("document.getElementById('theme').click()")
        self.assertEqual(grounds["light"], self.ground())
        browser.refresh()
        self.live()
        self.assertEqual(grounds["light"], self.ground())
        browser.execute_script("localStorage.clear()")
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})

    def test_no_width_needs_sideways_scrolling_and_stop_is_always_there(self):
        for size in [(390, 844), (800, 900), (1280, 800)]:
            self.open(robots=20, size=size)
            self.live()
            self.until("document.querySelectorAll('#runs tbody tr').length === 3")
            self.assertLessEqual(self.js("document.documentElement.scrollWidth"), size[0])
            for share in [0, 0.5, 1]:
                browser.execute_script("scrollTo(0, arguments[0] * document.body.scrollHeight)",
                                       share)
                top = self.js("""((stop, b = stop.getBoundingClientRect()) => stop.contains(
                    document.elementFromPoint(b.left + b.width / 2, b.top + b.height / 2)))(
                    document.getElementById('stop'))""")
                self.assertTrue(top, f"stop is not to be seen at {size}, {share}")


class Files(PageTest):
    def test_a_chart_as_svg_and_csv(self):
        self.open(robots=2, size=(1280, 2200))
        self.live()
        self.until("labPage.charts.msd.pointsDrawn() > 10")
        browser.execute_script("document.documentElement.dataset.theme = 'dark'")
        root = xml.etree.ElementTree.fromstring(self.js("labPage.charts.msd.svgText()").encode())
        self.assertEqual("dark", self.js("document.documentElement.dataset.theme"))
        browser.execute_script("localStorage.clear()")
        self.assertEqual("{http://www.w3.org/2000/svg}svg", root.tag)
        self.assertEqual("white", root[0].get("fill"))
        words = [e.text for e in root.iter("{http://www.w3.org/2000/svg}text")]
        self.assertIn("MSD (cm²)", words)
        self.assertIn("lag (s)", words)
        inks = {e.get("fill") for e in root.iter("{http://www.w3.org/2000/svg}text")}
        self.assertEqual({"rgb(26, 29, 33)"}, inks)
        self.assertFalse([e for e in root.iter() if e.get("class") or e.get("style")])
        rows = list(csv.reader(io.StringIO(self.js("labPage.charts.msd.csvText()"))))
        self.assertEqual(["of", "lag (s)", "value (cm^2)", "sigma (cm^2)", "exact (cm^2)",
                          "paper (cm^2)", "windows",
                          "biased"], rows[0])
        self.assertEqual(3 * 24, len(rows) - 1)
        curve = next(p for p in [self.js("labPage.stream.topics.get('pool/abp')")])["curves"][0]
        self.assertEqual(curve["lag"], [float(row[1]) for row in rows[1:25]])

    def test_a_click_makes_a_file(self):
        self.open(robots=2, size=(1280, 2200))
        self.live()
        self.until("labPage.charts.msd.pointsDrawn() > 10")
        with tempfile.TemporaryDirectory() as folder:
            browser.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow",
                                                                    "downloadPath": folder})
            for kind in ["SVG", "CSV"]:
                browser.find_element(By.CSS_SELECTOR, f"[aria-label='MSD as {kind}']").click()
                file = pathlib.Path(folder) / f"MSD.{kind.lower()}"
                end = time.monotonic() + 5
                while not file.exists() and time.monotonic() < end:
                    time.sleep(0.05)
                self.assertGreater(file.stat().st_size, 500)


class Connection(PageTest):
    server_goes = True

    def test_the_server_goes_and_comes_back(self):
        self.open(robots=5)
        self.live()
        browser.execute_script("window.notReloaded = true")
        self.lab.stop_serving()
        self.says("banner", "no word from the server since")
        self.press(Keys.SPACE)
        self.says("stop-missing", "STOP NOT SENT")
        frames = self.js("labPage.view.arena.frames")
        self.lab.serve()
        self.until("document.getElementById('banner').hidden")
        self.until(f"labPage.view.arena.frames > {frames + 10}")
        self.assertTrue(self.js("window.notReloaded"))
        self.until("labPage.controls.stopText.startsWith('stopped: all 5')")
        self.assertEqual("", self.text("stop-missing"))

    def test_a_stop_that_was_never_sent_is_still_told_after_a_reconnect(self):
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
        self.assertEqual([], self.wishes("stop"), "nobody presses so late")
        self.assertIn("STOP NOT SENT", self.text("stop-missing"))

    def test_a_connection_that_only_stands_is_given_up(self):
        self.open(robots=5)
        self.live()
        self.lab.mute = True
        self.until("labPage.stream.attempts > 0", 12)
        self.assertIn("no word from the server", self.text("banner"))
        self.lab.mute = False
        self.until("document.getElementById('banner').hidden")

    def test_a_silent_bus_is_said_and_survived(self):
        self.open(robots=5)
        self.live()
        self.lab.silent = True
        self.says("banner", "the lab is silent for")
        self.lab.silent = False
        self.until("document.getElementById('banner').hidden")
        self.assertEqual(0, self.js("labPage.stream.attempts"))

    def test_a_page_that_nobody_sees_gives_its_connection_back(self):
        self.open(robots=5)
        self.live()
        browser.execute_script("""labPage.stream.hiddenPatience = 100;
            Object.defineProperty(document, 'hidden', {configurable: true, get: () => true});
            document.dispatchEvent(new Event('visibilitychange'));""")
        self.until("labPage.stream.attempts === 1 && !labPage.stream.connected")
        time.sleep(2)
        self.assertFalse(self.js("labPage.stream.connected"))
        browser.execute_script("delete document.hidden;"
                               "document.dispatchEvent(new Event('visibilitychange'))")
        self.until("labPage.stream.connected")

    def test_a_page_that_was_too_slow_skips_to_the_newest_state(self):
        self.open(robots=20)
        self.live()
        before, ticks = self.js("labPage.view.arena.frames"), self.lab.world.ticks
        browser.execute_script("const end = performance.now() + 3000;"
                               "while (performance.now() < end);")
        missed, newest = self.lab.world.ticks - ticks, self.lab.world.frame()["t_us"]
        self.until(f"labPage.stream.topics.get('frame').t_us >= {newest}")
        shown = self.js("labPage.view.arena.frames") - before
        print(f"{missed} frames came while the page stood, it took {shown} of them")
        self.assertLess(shown, missed / 2)


class Replay(PageTest):
    def test_a_recorded_run_is_played_and_no_robot_can_be_commanded(self):
        self.open(robots=3, replay=True)
        self.live()
        self.until("!document.getElementById('player').hidden && labPage.controls.control")
        self.assertTrue(self.js("document.getElementById('stop').disabled"))
        self.assertIn("recorded", self.text("read-only"))
        browser.execute_script("const s = document.getElementById('player-at'); s.value = 100;"
                               "s.dispatchEvent(new Event('change'))")
        self.says("player-text", "1:4")
        self.assertEqual([{"wish": "seek", "to_s": 100}], self.wishes("seek"))
        browser.execute_script("document.getElementById('player-go').click()")
        self.says("player-go", "play")
        self.press(Keys.SPACE)
        self.says("stop-missing", "A recorded run")
        self.assertEqual([], self.wishes("stop"))

    def test_what_was_measured_elsewhere_in_the_run_is_forgotten(self):
        self.server_refuses = True
        self.open(robots=3, replay=True, size=(1280, 2200))
        self.live()
        self.until("labPage.charts.msd.pointsDrawn() === 72"
                   " && labPage.charts.runtimes.pointsDrawn() > 0")
        self.lab.pools = 0
        time.sleep(1.2)
        self.lab.wish({"wish": "seek", "to_s": 100})
        self.until("labPage.charts.msd.pointsDrawn() === 0"
                   " && labPage.charts.runtimes.pointsDrawn() === 0"
                   " && labPage.stream.all('history/').length === 0")
        self.lab.world.wish = lambda _: "refused: not now"
        browser.execute_script("document.getElementById('player-go').click()")
        self.says("player-say", "pause: refused: not now")
        self.lab.world.replay = False
        self.lab.publish("lab", dict(self.lab.world.lab(), run="live"))
        self.until("document.getElementById('player').hidden")
        self.until("!document.getElementById('stop').disabled")


class PastRuns(PageTest):
    def test_runs_are_listed_and_two_are_compared(self):
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

    def test_an_experiment_is_checked_and_started(self):
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
    if not CHROMEDRIVER.exists():
        print("page_test: no chromedriver (Debian: chromium, chromium-driver)")
        sys.exit(77)
    unittest.main(verbosity=2 if "-v" in sys.argv else 1)
