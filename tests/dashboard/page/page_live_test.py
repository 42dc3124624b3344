"""The page in a browser, against mock_lab.py: the display of a running lab."""

import time

from page_case import PageTest, browser, main, processor_time


# A copy of a canvas: Chrome warns in the console if the page's own is read several times.
COPY = """((canvas) => {
    const copy = new OffscreenCanvas(canvas.width, canvas.height)
        .getContext('2d', {willReadFrequently: true});
    copy.drawImage(canvas, 0, 0);
    return copy;
})"""


class Live(PageTest):
    def test_shows_twenty_moving_robots(self):
        self.open(robots=20)
        self.live()
        before = {r["id"]: r for r in self.js("labPage.robots()")}
        self.assertEqual(sorted(before), list(range(1, 21)))
        self.js("window.before = arguments[0]", before)
        self.until("labPage.robots().every(({id, x, y}) => x !== before[id].x || y !== before[id].y)")

    def test_draws_robots_at_their_positions(self):
        self.open(robots=3)
        self.live()
        browser.execute_script("document.getElementById('show-trails').click()")
        self.js("labPage.controls.stop('test')")
        self.until("labPage.controls.stopText.startsWith('stopped')")
        painted = """(canvas => {
            const [width, height] = [canvas.width, canvas.height];
            const all = {COPY}(canvas).getImageData(0, 0, width, height).data;
            const scale = Math.min(width / 126, height / 96); // the arena and 3 cm around it
            return labPage.robots().map(({x, y, angle}) => { // behind the letter, not on the nose
                const column = Math.round(width / 2 + (x - 2.8 * Math.cos(angle) - 60) * scale);
                const row = Math.round(height / 2 - (y - 2.8 * Math.sin(angle) - 45) * scale);
                return [...all.slice(4 * (row * width + column), 4 * (row * width + column) + 4)];
            });
        })(document.getElementById('arena-over'))""".replace("{COPY}", COPY)
        expected = [[213, 94, 0, 255], [0, 158, 115, 255], [0, 114, 178, 255]]
        self.until(f"JSON.stringify({painted}) === JSON.stringify({expected})")

    def test_a_hundred_robots_leave_enough_time_for_30_frames_per_second(self):
        # Measures the processor time of the browser's processes, which does not depend on the other load
        # of the host: that of a second without the arena, and that of one frame of the arena.
        self.open(robots=100)
        self.live()
        time.sleep(3)
        with_arena, pictures = self.three_seconds()
        browser.execute_script("document.getElementById('runs-section').scrollIntoView()")
        time.sleep(1)
        without_arena, none = self.three_seconds()
        self.assertEqual(0, none)
        picture = max(0, with_arena - without_arena) / pictures
        print(f"100 robots: {1e3 * picture:.1f} ms of processor time per frame, "
              f"{1e3 * without_arena / 3:.0f} ms per "
              f"second without the arena; {pictures / 3:.0f} frames per second")
        self.assertLess(30 * picture + without_arena / 3, 1)

    def three_seconds(self):
        """@return (processor time [s], number of frames)"""
        spent, pictures = processor_time(), self.js("labPage.view.pictures")
        time.sleep(3)
        return processor_time() - spent, self.js("labPage.view.pictures") - pictures

    def test_draws_curves_after_the_first_analysis(self):
        self.open(robots=20, size=(1280, 2200), pools=0)
        self.live()
        self.assertEqual(0, self.js("labPage.charts.msd.pointsDrawn()"))
        self.lab.pools = 1
        self.until("labPage.stream.topics.has('pool/abp')")
        begin = time.monotonic()
        for chart in ["msd", "angular_msd", "C_l", "runtimes"]:
            self.until(f"labPage.charts.{chart}.pointsDrawn() > 10")
        print(f"curves are drawn {time.monotonic() - begin:.2f} s after the first analysis")
        self.until("document.querySelectorAll('#estimates tbody tr').length === 9")
        self.assertEqual(9, self.js("document.querySelectorAll('#chart-msd > svg .hollow').length"))

    def test_shows_the_crowd(self):
        self.open(robots=20, size=(1280, 3600))
        self.live()
        self.until("document.querySelectorAll('#crowd-numbers tbody tr').length === 6")
        self.until("document.querySelectorAll('#chart-pairs path.line').length > 1")
        # Read from a copy: a browser warns of contexts that are read often.
        painted = """(canvas => {
            const copy = document.createElement('canvas');
            [copy.width, copy.height] = [canvas.width, canvas.height];
            const context = copy.getContext('2d', {willReadFrequently: true});
            context.drawImage(canvas, 0, 0);
            const data = context.getImageData(0, 0, copy.width, copy.height).data;
            let coloured = 0;
            for (let i = 0; i < data.length; i += 4)
                if (Math.max(data[i], data[i + 1], data[i + 2])
                    - Math.min(data[i], data[i + 1], data[i + 2]) > 60) ++coloured;
            return coloured / (data.length / 4);
        })(document.getElementById('crowd-arena'))"""
        # Twenty robots cover 8 % of the arena; some of them are grey.
        self.until(painted + " > 0.01")
        for colour in ["density", "heading"]:
            browser.execute_script("const s = document.getElementById('crowd-colour');"
                                   "s.value = arguments[0]; s.dispatchEvent(new Event('change'))",
                                   colour)
            self.until(painted + " > 0.04")
        browser.execute_script("const s = document.getElementById('crowd-source'); s.value = 'rtp';"
                               "s.dispatchEvent(new Event('change'))")
        self.says("crowd-text", "7.00 robots on average")

    def test_shows_numbers_of_the_crowd_under_any_name(self):
        self.open(robots=3, size=(1280, 3600))
        crowd = self.lab.world.crowd

        def with_names_of_objects(program=None):
            made = crowd(program)
            first = made["observables"][0]
            made["observables"] += [dict(first, name=name) for name in ("constructor", "__proto__")]
            return made

        self.lab.world.crowd = with_names_of_objects
        self.live()
        self.until("document.querySelectorAll('#crowd-numbers tbody tr').length === 8")
        self.assertEqual(["polar order", "constructor", "  proto  "], self.js(
            "[0, 6, 7].map((row) => document.querySelectorAll('#crowd-numbers tbody tr')[row]"
            ".cells[0].textContent)"))

    def test_the_crowd_is_hidden_without_results(self):
        self.open(robots=3, pools=0)
        self.live()
        self.assertTrue(self.js("document.getElementById('crowd-section').hidden"))

    def test_shows_one_robot_or_fewer_programs(self):
        self.open(robots=6, size=(1280, 2200))
        self.live()
        self.until("labPage.charts.msd.pointsDrawn() === 72")
        browser.execute_script("document.querySelector('#curves-programs input').click()")
        self.until("labPage.charts.msd.pointsDrawn() === 48")
        browser.execute_script("const s = document.getElementById('curves-source'); s.value = '4';"
                               "s.dispatchEvent(new Event('change'))")
        self.until("labPage.charts.msd.pointsDrawn() === 24")

    def test_text_from_the_lab_is_never_html(self):
        self.open(robots=2)
        self.lab.world.life = 61.0
        self.live()
        self.says("script-now", "half <b>light</b>")
        self.assertEqual(0, self.js("document.querySelectorAll('main b, main i').length"))

    def test_accepts_missing_topics_and_nulls(self):
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
                             ("unknown topic", None),
                             ("runtimes/x", {"program": "x", "gamma_per_s": None, "edges_s": [],
                                             "counts": []})]:
            self.lab.publish(topic, value)
        self.until("labPage.stream.topics.has('runtimes/x')")
        time.sleep(0.5)

    def test_shows_the_end_of_a_run(self):
        self.open(robots=2)
        self.live()
        self.lab.take_request({"request": "end"})
        self.says("banner", "the run has ended: ended by dashboard")
        self.server_goes = True  # the server ends after a run, which is not a problem
        self.lab.stop_serving()
        time.sleep(4)
        self.assertIn("the run has ended", self.text("banner"))

    def test_another_run_removes_the_curves_of_the_previous_one(self):
        self.open(robots=4, size=(1280, 2200))
        self.live()
        self.until("labPage.charts.msd.pointsDrawn() > 10")
        self.lab.pools = 0
        time.sleep(1.2)
        self.lab.publish("lab", dict(self.lab.world.lab(), run="another"))
        self.until("labPage.charts.msd.pointsDrawn() === 0")
        self.says("run-name", "another")

    def test_removed_topics_are_removed_from_the_page(self):
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
            self.lab.publish(topic, None)  # published again within a second
        time.sleep(1.5)
        self.until("labPage.stream.topics.has('robots')")

    def test_requests_the_light_again_after_a_failure(self):
        self.server_refuses = True
        self.open(robots=2)
        self.lab.broken.add("/api/light")
        each = self.lab.world.each_second
        self.lab.world.each_second = lambda pools: [one for one in each(pools) if one[0] != "light"]
        time.sleep(1)
        self.lab.publish("light", dict(self.lab.world.light(), version=7))  # without another change
        self.lab.requests.clear()
        self.comes(2, lambda: self.asked("/api/light"))
        before = len(self.asked("/api/light"))
        self.lab.broken.clear()
        self.comes(before + 1, lambda: self.asked("/api/light"))
        self.until(f"((c) => {COPY}(c).getImageData(c.width / 2, c.height / 2, 1, 1)"
                   ".data[0])(document.getElementById('arena-under')) > 150")  # the centre is lit
        time.sleep(3)
        self.assertEqual(before + 1, len(self.asked("/api/light")), "requested once after success")

    def test_shows_numbers_of_omitted_entries(self):
        self.open(robots=2, size=(1280, 6000))
        world = self.lab.world
        timeline, health = world.timeline, world.health
        world.timeline = lambda: dict(timeline(), steps_before=12, marks_before=3, faults_before=4)
        world.health = lambda: dict(health(), streams_left_out=5)
        self.live()
        self.says("timeline-more", "12 earlier steps, 7 earlier marks and faults")
        self.says("streams-more", "5 more streams")


if __name__ == "__main__":
    main()
