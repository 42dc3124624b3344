"""The page in a browser, against mock_lab.py: stops, keyboard and permissions."""

import time

from page_case import By, Keys, PageTest, TOKEN, browser, main


class Keyboard(PageTest):
    def test_space_stops_all_robots_and_shows_the_confirmation(self):
        self.open(robots=20)
        self.live()
        browser.find_element(By.TAG_NAME, "body").send_keys(Keys.SPACE)
        self.until("labPage.controls.stopText === 'stopped: all 20 robots, 84 ms, by dashboard'")
        self.assertEqual(1, len(self.sent_requests("stop")))
        flags = {r[5] for r in self.js("labPage.stream.topics.get('frame').robots")}
        self.assertEqual({2}, flags)
        browser.find_element(By.TAG_NAME, "body").send_keys(Keys.SPACE)  # a second stop changes nothing
        self.until("labPage.controls.stopText === 'stopped: all 20 robots, 84 ms, by dashboard'")
        self.assertEqual("", self.text("stop-missing"))

    def test_sends_a_stop_before_the_permissions_are_known(self):
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
        self.assertTrue(self.js("labPage.controls.control"), "the last known permission stays")

    def test_sends_a_stop_when_all_connections_are_in_use(self):
        self.open(robots=3)
        self.live()
        browser.execute_script("for (let i = 0; i < 5; ++i) fetch(`/api/stream?${i}`)"
                               ".then((stream) => stream.text()).catch(() => {})")
        time.sleep(1)
        self.press(Keys.SPACE)
        self.comes(1, lambda: self.sent_requests("stop"))

    def test_sends_a_stop_until_it_is_accepted_or_released(self):
        self.server_refuses = True
        self.open(robots=3)
        self.live()
        take, self.lab.world.take_request = self.lab.world.take_request, lambda _: "refused: not yet"
        self.press(Keys.SPACE)
        self.says("stop-missing", "STOP NOT SENT: refused: not yet")
        self.comes(3, lambda: self.sent_requests("stop"))
        self.lab.world.take_request = take
        self.until("labPage.controls.stopText.startsWith('stopped: all 3')")
        self.assertEqual("", self.text("stop-missing"))
        sent = len(self.sent_requests("stop"))
        time.sleep(1)
        self.assertEqual(sent, len(self.sent_requests("stop")))

        self.lab.world.take_request = lambda _: "refused: not yet"
        self.press(Keys.SPACE)
        self.says("stop-missing", "STOP NOT SENT")
        browser.execute_script("document.querySelector('#release-place > button').click();"
                               "document.querySelector('#release-place span button').click()")
        self.comes(1, lambda: self.sent_requests("release_stop"))
        time.sleep(0.5)
        sent = len(self.sent_requests("stop"))
        time.sleep(1.5)
        self.assertEqual(sent, len(self.sent_requests("stop")))

    def test_names_robots_that_do_not_confirm_a_stop(self):
        self.open(robots=20)
        self.lab.world.deaf = [3, 7]
        self.live()
        self.press(Keys.SPACE)
        self.says("stop-missing", "NOT confirmed: 3, 7")
        self.assertIn("18 of 20 confirmed", self.text("stop-state"))

    def test_space_on_a_focused_button_stops_and_does_not_press_it(self):
        self.open(robots=2)
        self.live()
        for identity in ["pause", "follow", "show-trails", "light-hold", "light-level"]:
            before = len(self.sent_requests("stop"))
            browser.execute_script("document.getElementById(arguments[0]).focus()", identity)
            self.press(Keys.SPACE)
            end = time.monotonic() + 60
            while len(self.sent_requests("stop")) == before and time.monotonic() < end:
                time.sleep(0.02)
            self.assertEqual(before + 1, len(self.sent_requests("stop")), identity)
        self.assertEqual([], self.sent_requests("pause"))
        self.assertTrue(self.js("document.getElementById('show-trails').checked"))

    def test_space_in_a_text_field_is_text_and_escape_leaves_the_field(self):
        self.open(robots=2)
        self.live()
        browser.execute_script("document.getElementById('mark-text').focus()")
        self.press("a b")
        self.assertEqual("a b", self.js("document.getElementById('mark-text').value"))
        self.press(Keys.ENTER)
        self.says("events", "dashboard: a b")
        self.assertEqual([], self.sent_requests("stop"))
        self.press(Keys.ESCAPE)
        self.assertEqual("BODY", self.js("document.activeElement.tagName"))

    def test_stop_is_the_first_control_and_all_controls_have_labels(self):
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

    def test_release_and_end_need_a_confirmation(self):
        self.open(robots=2)
        self.live()
        self.press(Keys.SPACE)
        self.until("labPage.controls.stopText.startsWith('stopped')")
        for place, name in [("release-place", "release_stop"), ("end-place", "end")]:
            browser.execute_script("document.querySelector('#' + arguments[0] + ' button').focus()",
                                   place)
            self.press(Keys.ENTER)
            self.assertEqual("no", self.js("document.activeElement.textContent"))
            self.assertEqual([], self.sent_requests(name))
            browser.execute_script(f"document.querySelector('#{place} span button').focus()")
            self.press(Keys.ENTER)
            end = time.monotonic() + 60
            while not self.sent_requests(name) and time.monotonic() < end:
                time.sleep(0.02)
            self.assertEqual(1, len(self.sent_requests(name)))

    def test_selects_follows_and_zooms_by_keyboard(self):
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
        self.says("robot-facts", "programrtp: v 8 cm/s, γ 1 1/s, τt 0.2 s (phase tumble)")
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

    def test_a_click_selects_a_robot(self):
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


class Permissions(PageTest):
    def test_without_the_token_all_buttons_are_disabled_with_a_reason(self):
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

    def test_the_token_is_never_part_of_a_requested_address_and_survives_a_reload(self):
        self.open(robots=2)
        self.live()
        browser.refresh()
        self.live()
        self.until("labPage.controls.control")
        self.assertEqual([], [path for _, path in self.lab.requests if TOKEN in path])
        self.assertNotIn(TOKEN, browser.current_url)

    def test_shows_why_a_request_is_refused(self):
        self.server_goes = True
        self.open(robots=2)
        self.live()
        self.until("labPage.controls.control")
        self.lab.read_only = True
        browser.execute_script("document.getElementById('pause').click()")
        self.says("note", "pause: this page is read-only")
        browser.get_log("browser")  # the browser reports the 403 there


if __name__ == "__main__":
    main()
