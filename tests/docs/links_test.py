#!/usr/bin/env python3
"""Every link of every page has a target, and every page is in the contents of the manual.

    links_test.py ROOT
"""
import re
import sys
import unittest
from functools import lru_cache
from pathlib import Path

from markdown import Page

ROOT = Path()
FOLDERS = ("docs", "experiments", "tests", "lcmtypes", "cmake", "common", "robot", "light", "analyzer",
           "robot_bridge", "projector_ctl", "tracker_svc", "sim_svc", "dds_gateway", "dashboard",
           "runner")
SOURCES = tuple(name for name in FOLDERS if name not in ("docs", "experiments", "tests", "cmake"))


@lru_cache(maxsize=None)
def page(name):
    return Page(ROOT, name)


def pages():
    for path in sorted(ROOT.rglob("*.md")):
        name = path.relative_to(ROOT)
        if not any(part.startswith(".") or part == "build" for part in name.parts):
            yield str(name)


class Links(unittest.TestCase):
    def nothing(self, wrong):
        if wrong:
            self.fail("\n" + "\n".join(wrong))

    def test_have_targets(self):
        wrong = []
        for name in pages():
            for line, link in page(name).links():
                if re.match(r"^[a-z]+:", link):
                    continue
                file, _, anchor = link.partition("#")
                target = (ROOT / name).parent / file if file else ROOT / name
                if not target.exists():
                    wrong.append(f"{name}:{line}: there is no {link}")
                elif anchor and target.suffix == ".md":
                    relative = str(target.resolve().relative_to(ROOT))
                    if anchor not in page(relative).anchors():
                        wrong.append(f"{name}:{line}: {file or name} has no heading #{anchor}")
        self.nothing(wrong)

    def test_named_files_exist(self):
        wrong = []
        for name in pages():
            if name == "CHANGELOG.md":  # it also names files of earlier versions
                continue
            for line, code in page(name).inline_code():
                if re.match(rf"^({'|'.join(FOLDERS)})/[\w/-]+\.\w+$", code) and "/X/" not in code:
                    if not (ROOT / code).exists():
                        wrong.append(f"{name}:{line}: there is no {code}")
        self.nothing(wrong)

    def test_every_row_of_security_names_its_test(self):
        """In tables with the column `test`: files that exist, and (Beginning…) of names in them."""
        wrong, heads, rows, has_tests = [], 0, 0, False
        for line, row in page("docs/security.md").prose:
            cells = [cell.strip() for cell in row.split("|")[1:-1]] if row.startswith("|") else []
            if not cells:
                has_tests = False
            elif cells[-1] == "test":
                has_tests = True
                heads += 1
            elif has_tests and set(cells[-1]) != {"-"}:
                rows += 1
                files = re.findall(r"`(tests/[^`]+)`", cells[-1])
                texts = "".join((ROOT / file).read_text(encoding="utf-8")
                                for file in files if (ROOT / file).is_file())
                if not texts:
                    wrong.append(f"docs/security.md:{line}: the row names no test that exists")
                wrong += [f"docs/security.md:{line}: there is no test {name}…"
                          for name in re.findall(r"(\w+)…", cells[-1]) if f", {name}" not in texts]
        self.nothing(wrong)
        self.assertGreaterEqual(heads, 4)
        self.assertGreater(rows, 35)

    def test_quoted_messages_are_printed(self):
        """In the tables of symptoms; an ellipsis stands for the part that varies."""
        sources = [path.read_text(encoding="utf-8") for folder in SOURCES
                   for path in sorted((ROOT / folder).rglob("*.[ch]pp"))]
        printed = re.sub(r'"\s*(?:R?")', "", "\n".join(sources))  # joins adjacent string literals
        wrong = []
        for line, row in page("docs/troubleshooting.md").prose:
            first_cell = row.split("|")[1] if row.startswith("|") else ""
            for quoted in re.findall(r"`([^`]+)`", first_cell):
                wrong += [f"docs/troubleshooting.md:{line}: no program prints: {part}"
                          for part in re.split(r"\s*…\s*", quoted)
                          if part not in printed and not part.startswith("--")]
        self.nothing(wrong)

    def test_every_page_is_in_the_contents(self):
        listed = {Path(link.partition("#")[0]).name for _, link in page("docs/README.md").links()}
        missing = [path.name for path in (ROOT / "docs").glob("*.md")
                   if path.name not in listed | {"README.md"}]
        self.nothing([f"not in docs/README.md: {name}" for name in missing])


if __name__ == "__main__":
    ROOT = Path(sys.argv[1]).resolve()
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
