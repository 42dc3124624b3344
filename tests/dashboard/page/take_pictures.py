"""Takes the screenshots of the page for the manual, from a real lab.

  tests/in_private_network.sh /usr/bin/python3 tests/dashboard/page/take_pictures.py FOLDER_OF_PROGRAMS [SECONDS]
"""

import pathlib
import sys
import tempfile
import time

sys.dont_write_bytecode = True
import lab_page_test
from page_case import browser

ROOT = pathlib.Path(__file__).resolve().parents[3]
VARIANTS = [("light", (1280, 1560), False), ("dark", (1280, 860), True), ("phone", (390, 844), False)]


def main():
    folder = ROOT / "docs" / "pictures"
    folder.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        lab = lab_page_test.Lab(pathlib.Path(sys.argv[1]).resolve(), ROOT / "experiments",
                                temporary, "half_dark_arena", "--set", "robots[0].count=12")
        try:
            browser.get(lab.address())
            time.sleep(float(sys.argv[2]) if len(sys.argv) > 2 else 100)
            browser.execute_script("labPage.view.choose?.(3)")
            for name, (width, height), dark in VARIANTS:
                browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
                    "width": width, "height": height, "deviceScaleFactor": 1,
                    "mobile": width < 600})
                browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
                    {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})
                time.sleep(3)
                browser.save_screenshot(str(folder / f"dashboard_{name}.png"))
        finally:
            lab.end()


if __name__ == "__main__":
    main()
