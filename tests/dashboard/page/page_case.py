"""Base of the tests of the dashboard's page in a browser, with mock_lab.py as its server.

  python3 tests/dashboard/page/page_live_test.py      (exit status 77: chromium or selenium is missing)
"""

import atexit
import json
import os
import pathlib
import sys
import time
import unittest

sys.dont_write_bytecode = True
try:
    from selenium import webdriver
    from selenium.common.exceptions import WebDriverException
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    print("page_case: no selenium (Debian: python3-selenium)")
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


if not CHROMEDRIVER.exists():
    print("page_case: no chromedriver (Debian: chromium, chromium-driver)")
    sys.exit(77)
browser = new_browser()  # shared by all tests of a process
atexit.register(browser.quit)


def processor_time():
    """Processor time of the browser and all its child processes [s]."""
    parents, spent = {}, {}
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        parents[int(entry.name)] = int(fields[1])
        spent[int(entry.name)] = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def is_of_browser(process):
        while process in parents and process != browser.service.process.pid:
            process = parents[process]
        return process in parents

    return sum(time for process, time in spent.items() if is_of_browser(process))


class PageTest(unittest.TestCase):
    """Each test has its own mock lab. At the end the browser's console must be empty."""

    server_goes = False  # whether the test ends the server, which the browser reports in the console
    server_refuses = False  # whether the server refuses requests, which the browser reports too

    def open(self, token=True, size=(1280, 1000), **lab):
        self.lab = MockLab(**lab).serve()
        self.token = token
        self.addCleanup(self.lab.close)
        self.addCleanup(browser.get, "about:blank")
        self.addCleanup(self.check_console)
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size[0] < 600})
        browser.get_log("browser")
        browser.get(self.lab.address_with_token if token else self.lab.address)

    def check_console(self):
        log = browser.get_log("browser")
        if self.server_goes:
            log = [entry for entry in log
                   if not any(word in entry["message"] for word in LOST_SERVER)]
        if self.server_refuses:
            log = [entry for entry in log if REFUSED not in entry["message"]]
        self.assertEqual([], log, "the console is not empty")

    def js(self, text, *arguments):
        return browser.execute_script("return " + text, *arguments)

    def until(self, text, timeout=60.0):
        """Waits until the JavaScript expression is true; returns its value."""
        end = time.monotonic() + timeout
        while True:
            try:
                value = self.js(text)
            except WebDriverException:
                value = None  # the page is still loading
            if value:
                return value
            self.assertLess(time.monotonic(), end, f"not within {timeout} s: {text}")
            time.sleep(0.05)

    def live(self):
        self.until("window.labPage && labPage.robots().length > 0"
                   " && labPage.stream.topics.has('stop')"
                   f" && document.body.dataset.control === '{str(self.token).lower()}'")

    def text(self, identity):
        return self.js("document.getElementById(arguments[0]).textContent", identity)

    def says(self, identity, words):
        """Waits until the element's text contains the words."""
        self.until(f"document.getElementById('{identity}').textContent"
                   f".includes({json.dumps(words)})")

    def press(self, *keys):
        browser.switch_to.active_element.send_keys(*keys)

    def sent_requests(self, name):
        return [body for _, body in self.lab.operator_requests if body["request"] == name]

    def comes(self, count, found):
        """Waits until found() has at least `count` elements."""
        end = time.monotonic() + 60
        while len(found()) < count:
            self.assertLess(time.monotonic(), end, "too few elements")
            time.sleep(0.02)

    def asked(self, path):
        return [one for _, one in self.lab.requests if one == path]


def main():
    unittest.main(verbosity=2 if "-v" in sys.argv else 1)
