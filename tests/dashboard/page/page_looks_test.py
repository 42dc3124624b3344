"""The page in a browser, against mock_lab.py: screen sizes, themes, exported files."""

import csv
import io
import pathlib
import tempfile
import time
import xml.etree.ElementTree

from page_case import By, PageTest, browser, main


class Looks(PageTest):
    def ground(self):
        return self.js("getComputedStyle(document.body).backgroundColor")

    def test_theme_follows_the_system_and_the_button(self):
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

    def test_needs_no_horizontal_scrolling_and_stop_is_always_visible(self):
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
                self.assertTrue(top, f"stop is not visible at {size}, {share}")


class Files(PageTest):
    def test_exports_a_chart_as_svg_and_csv(self):
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
        self.assertEqual(["program", "lag (s)", "value (cm^2)", "sigma (cm^2)", "exact (cm^2)",
                          "paper (cm^2)", "windows",
                          "biased"], rows[0])
        self.assertEqual(3 * 24, len(rows) - 1)
        curve = next(p for p in [self.js("labPage.stream.topics.get('pool/abp')")])["curves"][0]
        self.assertEqual(curve["lag"], [float(row[1]) for row in rows[1:25]])

    def test_no_text_in_a_csv_file_is_a_formula(self):
        # Names come from the lab, and a spreadsheet would compute them.
        self.open(robots=2)
        self.live()
        text = browser.execute_async_script("""
            const [table, done] = arguments;
            import('/page/export.js').then(({csvText}) => done(csvText(table)));""", {
                "columns": ["program", "=v (cm/s)"],
                "rows": [['=HYPERLINK("http://x",1)', -1.5], ["+1", -2], ["-1", None], ["@x", 3],
                         ["\t=1", 4], ["a=b", 5]]})
        self.assertEqual([["program", "'=v (cm/s)"], ["'=HYPERLINK(\"http://x\",1)", "-1.5"],
                          ["'+1", "-2"], ["'-1", ""], ["'@x", "3"], ["'\t=1", "4"], ["a=b", "5"]],
                         list(csv.reader(io.StringIO(text))))

    def test_a_click_downloads_a_file(self):
        self.open(robots=2, size=(1280, 2200))
        self.live()
        self.until("labPage.charts.msd.pointsDrawn() > 10")
        with tempfile.TemporaryDirectory() as folder:
            browser.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow",
                                                                    "downloadPath": folder})
            for kind in ["SVG", "CSV"]:
                browser.find_element(By.CSS_SELECTOR, f"[aria-label='MSD as {kind}']").click()
                file = pathlib.Path(folder) / f"MSD.{kind.lower()}"
                end = time.monotonic() + 60
                while not file.exists() and time.monotonic() < end:
                    time.sleep(0.05)
                self.assertGreater(file.stat().st_size, 500)


if __name__ == "__main__":
    main()
