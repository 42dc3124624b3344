#!/usr/bin/env python3
"""Shows that the tests of the manual fail: each of these pages has a mistake.

    in_private_network.sh can_fail_test.py PROGRAMS
"""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
PROGRAMS = ""

GOOD = """# A page
```sh
./lab theory abp v_cm_s=3 epsilon_s=0.5 eta_rad_s=3 --lags 1
```
<!-- test: exit 2 -->
```sh
./lab check nothing.toml
```
<!-- test: skip needs a robot -->
```sh
./lab flash --port /dev/ttyUSB0
```
<!-- test: saved mine.toml -->
```toml
[arena]
width_cm = 100
```
```sh
cat mine.toml
```
"""
WRONG = {  # the change to the good page, and the expected message
    "a command that fails": (("--lags 1", "--lags nan"), "exit code of"),
    "an option that does not exist": (("--lags 1", "--lagz 1"), "lab theory has no option --lagz"),
    "an option of a command that is not run": (("--port", "--prot"),
                                               "lab flash has no option --prot"),
    "a command that does not exist": (("lab flash", "lab flush"), "lab has no command flush"),
    "a wrong exit code": (("exit 2", "exit 3"), "exit code of"),
    "a skip without a reason": (("skip needs a robot", "skip"), "say why it is not run"),
    "an unknown comment": (("skip needs", "slip needs"), "no such comment: slip"),
    "a comment before no block": (("# A page\n", "# A page\n<!-- test: exit 2 -->\n\n"),
                              "before no block"),
    "a block without its language": (("```sh\n./lab theory", "```\n./lab theory"), "not marked"),
    "an unknown key": (("width_cm", "widht_cm"), "unknown key"),
    "a file that does not exist": (("# A page\n", "# A page\n`./lab check experiments/gone.toml`\n"),
                            "there is no experiments/gone.toml"),
}


def result_of(page):
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        (root / "docs").mkdir()
        for name in ("experiments", "docs/examples", "lcmtypes", "lab", "python"):
            (root / name).symlink_to(ROOT / name)
        (root / "page.md").write_text(page, encoding="utf-8")
        test = str(HERE / "commands_test.py")
        ended = subprocess.run([sys.executable, "-B", test, folder, PROGRAMS, "page.md"],
                               text=True, capture_output=True, timeout=100, check=False)
        return ended.returncode, ended.stderr


class TestsOfTheManual(unittest.TestCase):
    def test_pass_a_good_page(self):
        code, output = result_of(GOOD)
        self.assertEqual(code, 0, output)

    def test_fail_on_wrong_pages(self):
        for name, ((old, new), expected) in WRONG.items():
            with self.subTest(name):
                self.assertIn(old, GOOD)
                code, output = result_of(GOOD.replace(old, new))
                self.assertNotEqual(code, 0)
                self.assertIn(expected, output)


if __name__ == "__main__":
    PROGRAMS = str(Path(sys.argv[1]).resolve())
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
