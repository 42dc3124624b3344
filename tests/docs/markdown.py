"""Reads a page of the manual: its blocks, headings and links."""
import re
from dataclasses import dataclass, field
from pathlib import Path

MARK = re.compile(r"^<!-- test: (\S+)\s*(.*?)\s*-->$")
WORDS = {"with", "instead", "first", "beside", "exit", "skip", "saved", "paragraphs"}


@dataclass
class Block:
    """A block of code. `kind` is the word after the fence, or `indented` for a block without one."""
    page: str
    line: int
    kind: str
    lines: list
    marks: list = field(default_factory=list)  # (word, rest) of each <!-- test: word rest -->

    @property
    def place(self):
        return f"{self.page}:{self.line}"

    @property
    def text(self):
        return "\n".join(self.lines)

    def mark(self, word):
        """The text after the word of a comment; None if the block has no such comment."""
        return next((rest for name, rest in self.marks if name == word), None)

    def all(self, word):
        return [rest for name, rest in self.marks if name == word]


class Page:
    """A Markdown file, split into blocks of code and prose (line number, line)."""

    def __init__(self, root, name):
        self.name, self.path = name, Path(root) / name
        self.blocks, self.prose = [], []
        self.stray_marks = []  # line numbers of comments before no block
        self._cut(self.path.read_text(encoding="utf-8").split("\n"))

    def _cut(self, lines):
        marks, at = [], 0
        while at < len(lines):
            line, begin = lines[at], at + 1
            mark = MARK.match(line)
            fence = re.match(r"^(`{3,}|~{3,})(\w*)", line)
            if mark:
                marks.append((begin, mark.group(1), mark.group(2)))
            elif fence:
                end = next(i for i in range(at + 1, len(lines))
                           if lines[i].startswith(fence.group(1)))
                self.blocks.append(Block(self.name, begin, fence.group(2), lines[at + 1:end],
                                         [(word, rest) for _, word, rest in marks]))
                marks, at = [], end
            elif line.startswith("    ") and self._is_code(at, lines):
                end = at
                while end < len(lines) and lines[end].startswith("    "):
                    end += 1
                body = [text[4:] for text in lines[at:end]]
                self.blocks.append(Block(self.name, begin, "indented", body))
                at = end - 1
            else:
                self.stray_marks += [number for number, _, _ in marks]
                marks = []
                self.prose.append((begin, line))
            at += 1

    @staticmethod
    def _is_code(at, lines):
        """Whether indented lines are code: after an empty line, unless they continue a list item."""
        above = next((text for text in reversed(lines[:at]) if text and text[0] != " "), "")
        return lines[at - 1].strip() == "" and not re.match(r"^([-*]|\d+\.) ", above)

    def anchors(self):
        """The anchors of the headings, as GitHub makes them."""
        found = set()
        for _, line in self.prose:
            heading = re.match(r"^#+ (.*)", line)
            if heading:
                slug = re.sub(r"[^\w\- ]", "", heading.group(1).replace("`", "").lower())
                slug = slug.replace(" ", "-")
                number, base = 0, slug
                while slug in found:
                    number += 1
                    slug = f"{base}-{number}"
                found.add(slug)
        return found

    def links(self):
        """(line, target) of each [text](target), pictures included."""
        for number, line in self.prose:
            for target in re.findall(r"\]\(([^()\s]+)\)", re.sub(r"`[^`]*`", "", line)):
                yield number, target

    def inline_code(self):
        for number, line in self.prose:
            for code in re.findall(r"`([^`]+)`", line):
                yield number, code


def logical_lines(lines):
    """Shell lines: joins continuations, removes comments and empty lines."""
    joined, part = [], ""
    for line in lines:
        if line.endswith("\\"):
            part += line[:-1]
            continue
        joined.append(part + line)
        part = ""
    return [cut for cut in (without_comment(line).rstrip() for line in joined) if cut.strip()]


def without_comment(line):
    quote = ""
    for at, letter in enumerate(line):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"":
            quote = letter
        elif letter == "#" and (at == 0 or line[at - 1].isspace()):
            return line[:at]
    return line
