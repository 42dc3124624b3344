#!/usr/bin/env python3
"""Every link of every page leads somewhere, and every chapter is in the book's contents.

    links_test.py ROOT
"""
import re
import sys
import unittest
from functools import lru_cache
from pathlib import Path

from markdown import Page

ROOT = Path()
FOLDERS = ("docs", "experiments", "tests", "lcmtypes", "cmake")


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

    def test_lead_somewhere(self):
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

    def test_files_that_are_named_exist(self):
        wrong = []
        for name in pages():
            if name == "CHANGELOG.md":  # also speaks of what is gone
                continue
            for line, code in page(name).inline_code():
                if re.match(rf"^({'|'.join(FOLDERS)})/[\w/-]+\.\w+$", code) and "/X/" not in code:
                    if not (ROOT / code).exists():
                        wrong.append(f"{name}:{line}: there is no {code}")
        self.nothing(wrong)

    def test_messages_that_are_quoted_are_printed(self):
        """In the tables by symptom; an ellipsis stands for what differs from time to time."""
        sources = [path.read_text(encoding="utf-8") for folder in ROOT.iterdir() if folder.is_dir()
                   for path in folder.glob("*.[ch]pp")]
        printed = re.sub(r'"\s*(?:R?")', "", "\n".join(sources))  # literals in pieces are one
        wrong = []
        for line, row in page("docs/troubleshooting.md").prose:
            first_cell = row.split("|")[1] if row.startswith("|") else ""
            for quoted in re.findall(r"`([^`]+)`", first_cell):
                wrong += [f"docs/troubleshooting.md:{line}: nobody says: {part}"
                          for part in re.split(r"\s*…\s*", quoted)
                          if part not in printed and not part.startswith("--")]
        self.nothing(wrong)

    def test_every_chapter_is_in_the_contents(self):
        listed = {Path(link.partition("#")[0]).name for _, link in page("docs/README.md").links()}
        missing = [path.name for path in (ROOT / "docs").glob("*.md")
                   if path.name not in listed | {"README.md"}]
        self.nothing([f"not in docs/README.md: {name}" for name in missing])


if __name__ == "__main__":
    ROOT = Path(sys.argv[1]).resolve()
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
