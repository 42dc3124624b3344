#!/usr/bin/env python3
"""Runs the commands of a page of the manual and checks its experiments.

    in_private_network.sh commands_test.py ROOT PROGRAMS PAGE [unittest's own arguments]

CONTRIBUTING.md explains the comments before blocks (<!-- test: ... -->).
"""
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest
from functools import lru_cache
from pathlib import Path

from markdown import Page, WORDS, logical_lines

OPTION = re.compile(r"^--?[a-zA-Z][\w-]*")
LINE_LIMIT_S = 300
HIDDEN = {"host-agent"}          # of lab: hidden from users
PASSES_ON = ["lab", "python"]    # its arguments are those of Python
AS_SWEEP = ["lab", "queue", "add"]  # its arguments are those of lab sweep
SCRIPT_ONLY = {"test", "package", "build"}  # of ./lab: not in the built program

ROOT, PROGRAMS, PAGE = Path(), Path(), None


@lru_cache(maxsize=None)
def help_of(*command):
    shown = subprocess.run([str(PROGRAMS / command[0]), *command[1:], "--help"], text=True,
                           capture_output=True, timeout=60, check=False)
    return shown.stdout + shown.stderr


def subcommands(*command):
    _, _, listed = help_of(*command).partition("Subcommands:")
    return set(re.findall(r"^ {2}([a-z][\w-]*)", listed, re.MULTILINE))


def options(*command):
    shown = help_of(*command)
    if command == ("robot_bridge",):  # its tools have their own command line
        shown += help_of("robot_bridge", "--list")
    return set(re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", shown)) | {"--help", "-h"}


def commands_in(line):
    """The words of each command of a shell line. The brackets of a synopsis are removed."""
    if "[-" in line:
        line = line.replace("[-", " -").replace("]", " ")
    lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
    lexer.whitespace_split, lexer.commenters = True, ""
    commands = [[]]
    try:
        for word in lexer:
            if (word and set(word) <= set(";&|()")) or word in ("do", "then", "exec"):
                commands.append([])
            else:
                commands[-1].append(word)
    except ValueError:  # an open quote: the line is prose
        return []
    return [words for words in commands if words]


def own_command(words):
    """The name and arguments of a command that starts one of our programs, else None."""
    name = words[0].removeprefix("./").removeprefix("build/release/bin/")
    name = "lab" if name == "active-lab" else name  # its name in the package
    if "/" in name or not (PROGRAMS / name).is_file() or not os.access(PROGRAMS / name, os.X_OK):
        return None
    return name, words[1:]


def own_commands(line):
    return [own for own in map(own_command, commands_in(line)) if own is not None]


def unknown_in(line):
    """The first command or option of a line that its program does not have; "" if there is none."""
    return next(filter(None, (unknown(name, rest) for name, rest in own_commands(line))), "")


def unknown(name, rest):
    command, rest = [name], list(rest)
    if name == "lab" and rest:
        if rest[0] in SCRIPT_ONLY:
            return unknown_to_script(rest)
        if rest[0] in HIDDEN or not re.match(r"^[a-z-]", rest[0]):
            return ""
    while rest and not rest[0].startswith("-") and subcommands(*command):
        if rest[0] not in subcommands(*command):
            return f"{' '.join(command)} has no command {rest[0]}"
        command.append(rest.pop(0))
    if command == PASSES_ON:
        return ""
    if command == AS_SWEEP:
        command = ["lab", "sweep"]
    for word in rest:
        option = OPTION.match(word)
        if option and option.group() not in options(*command):
            return f"{' '.join(command)} has no option {option.group()}"
    return ""


def unknown_to_script(words):
    script = (ROOT / "lab").read_text(encoding="utf-8")
    if not re.search(rf"^  {words[0]} ", script, re.MULTILINE):
        return f"./lab has no command {words[0]}"
    return next((f"./lab {words[0]} has no {word}" for word in words
                 if word.startswith("--") and word not in script), "")


def missing_file_in(line):
    """The first file of this project that a command line names and that does not exist."""
    for word in re.findall(r"(?<![\w/.~-])(?:experiments|docs/examples|tests|lcmtypes|python/examples)/[\w./-]+", line):
        if not (ROOT / word).exists():
            return f"there is no {word}"
    return ""


def with_options(lines, extra):
    """Appends options to every command of ours in a block. They replace settings of the same keys."""
    keys = re.findall(r"--set ([\w.\[\]]+)=", extra)

    def with_extra(line):
        for key in keys:
            line = re.sub(rf" --set {re.escape(key)}=\S+", "", line)
        return f"{line} {extra}"

    return [with_extra(line) if own_commands(line) else line for line in lines]


class Folder:
    """The folder where the commands of a page run: ./lab, experiments, examples, a private home."""

    def __init__(self):
        self.path = Path(tempfile.mkdtemp(prefix="lab-docs-"))
        for name in ("home", "runtime", "tmp", "build/release"):
            (self.path / name).mkdir(parents=True)
        (self.path / "runtime").chmod(0o700)
        for name in ("experiments", "docs/examples", "lcmtypes", "python/examples"):
            shutil.copytree(ROOT / name, self.path / name)
        (self.path / "lab").symlink_to(PROGRAMS / "lab")
        (self.path / "build/release/bin").symlink_to(PROGRAMS)
        self.environment = {
            **os.environ, "HOME": str(self.path / "home"), "TMPDIR": str(self.path / "tmp"),
            "XDG_RUNTIME_DIR": str(self.path / "runtime"), "CI": "1",
            "PATH": f"{PROGRAMS}:{os.environ['PATH']}"}
        self.environment.pop("LCM_DEFAULT_URL", None)

    def start(self, text):
        stream = tempfile.TemporaryFile("w+")
        text = f"trap 'echo \"failed: $BASH_COMMAND\"' ERR\n{text}"
        process = subprocess.Popen(
            ["bash", "-euE", "-o", "pipefail", "-c", text], cwd=self.path, env=self.environment,
            stdin=subprocess.DEVNULL, stdout=stream, stderr=subprocess.STDOUT,
            start_new_session=True)
        process.output = stream
        return process

    def finish(self, process, limit_s):
        try:
            code = process.wait(limit_s)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            code = f"none within {limit_s} s"
        output = output_of(process)
        process.output.close()
        return code, output

    def remove(self):
        shutil.rmtree(self.path, ignore_errors=True)


def output_of(process):
    process.output.seek(0)
    return process.output.read()


def end(folder, process):
    """Ends the process like Ctrl-C in a terminal."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGINT)
    return folder.finish(process, 30)


def merged(base, piece):
    """Merges tables; replaces all other values."""
    result = dict(base)
    for key, value in piece.items():
        joined = isinstance(value, dict) and isinstance(result.get(key), dict)
        result[key] = merged(result[key], value) if joined else value
    return result


def as_toml(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(k)} = {as_toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(as_toml(item) for item in value) + "]"
    return json.dumps(value, ensure_ascii=False)


def whole_experiment(table):
    """Completes a part of an experiment file. `layers` alone become the only step."""
    if "layers" in table:
        table = {"light": {"steps": [{"at_s": 0, **table}]}}
    if "fileversion" in table:
        return table
    base = Path(__file__).with_name("part_of.toml").read_text(encoding="utf-8")
    return merged(tomllib.loads(base), table)


def paragraphs(block):
    cut = block.mark("paragraphs") is not None
    return re.split(r"\n\s*\n", block.text) if cut else [block.text]


class Manual(unittest.TestCase):
    def setUp(self):
        self.folder = Folder()
        self.addCleanup(self.folder.remove)

    def nothing(self, wrong):
        if wrong:
            self.fail("\n" + "\n".join(wrong))

    def test_comments_are_valid(self):
        wrong = [f"{PAGE.name}:{line}: a comment before no block"
                 for line in PAGE.stray_marks]
        for block in PAGE.blocks:
            wrong += [f"{block.place}: no such comment: {word}" for word, _ in block.marks
                      if word not in WORDS]
            wrong += [f"{block.place}: say why it is not run" for reason in block.all("skip")
                      if not reason]
            if block.kind == "" and any(map(own_commands, logical_lines(block.lines))):
                wrong.append(f"{block.place}: commands in a block that is not marked ```sh")
        self.nothing(wrong)

    def test_commands_and_options_exist(self):
        wrong, checked = [], []
        for block in PAGE.blocks:
            if block.kind in ("sh", "text", "indented"):
                checked += [(block.place, line) for line in logical_lines(block.lines)]
            checked += [(block.place, line) for line in block.all("instead") + block.all("first")]
        checked += [(f"{PAGE.name}:{line}", code) for line, code in PAGE.inline_code()
                      if " " in code]
        for place, line in checked:
            problem = unknown_in(line) or missing_file_in(line)
            if problem:
                wrong.append(f"{place}: {problem}: {line}")
        self.nothing(wrong)

    def test_commands_run_and_experiments_load(self):
        """In the order of the page, in one folder: a block may use files of earlier blocks."""
        for block in PAGE.blocks:
            with self.subTest(block.place):
                if block.kind == "sh" and block.mark("skip") is None:
                    self.run_block(block)
                elif block.kind == "toml":
                    self.load_block(block)

    def run_block(self, block):
        lines = logical_lines(block.lines)
        if "<<" in block.text:  # a here-document is left unchanged
            lines = block.lines
        if block.mark("with") is not None:
            lines = with_options(lines, block.mark("with"))
        text = "\n".join(block.all("instead") or lines)
        companion = self.start_beside(block) if block.mark("beside") is not None else None
        try:
            self.prepare(block)
            begin = time.monotonic()
            code, output = self.folder.finish(self.folder.start(text), LINE_LIMIT_S)
            print(f"{block.place}: {time.monotonic() - begin:.1f} s", file=sys.stderr)
            self.assertEqual(code, int(block.mark("exit") or 0),
                             f"{block.place}: exit code of\n{text}\n\n{output[-3000:]}")
        finally:
            if companion is not None:
                code, output = end(self.folder, companion)
        if companion is not None:
            beside = f"{block.place}: in parallel ran {block.mark('beside')}\n{output}"
            self.assertIn(code, (0, 3), beside)

    def prepare(self, block):
        for command in block.all("first"):
            code, output = self.folder.finish(self.folder.start(command), LINE_LIMIT_S)
            self.assertEqual(code, 0, f"{block.place}: before it: {command}\n{output[-3000:]}")

    def start_beside(self, block):
        """Starts a lab that runs in parallel with the block."""
        companion = self.folder.start("exec " + block.mark("beside"))
        until = time.monotonic() + 60
        # Not any "running": the head of the output may name another running lab.
        while not re.search(r"^running  ", output_of(companion), re.MULTILINE):
            if companion.poll() is not None or time.monotonic() > until:
                _, output = end(self.folder, companion)
                self.fail(f"{block.place}: did not come up: {block.mark('beside')}\n{output}")
            time.sleep(0.05)
        return companion

    def load_block(self, block):
        tables = [tomllib.loads(piece) for piece in paragraphs(block)]
        if block.mark("saved") is not None:
            (self.folder.path / block.mark("saved")).write_text(block.text, encoding="utf-8")
        if block.mark("skip") is not None:
            return
        self.prepare(block)
        for table in tables:
            file = self.folder.path / "from_the_page.toml"
            text = "".join(f"{key} = {as_toml(value)}\n" for key, value in
                           whole_experiment(table).items())
            file.write_text(text, encoding="utf-8")
            command = f"./lab check {file.name} {block.mark('with') or ''}"
            code, output = self.folder.finish(self.folder.start(command), 60)
            self.assertEqual(code, int(block.mark("exit") or 0), f"{block.place}:\n{text}\n{output}")


if __name__ == "__main__":
    ROOT, PROGRAMS = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    PAGE = Page(ROOT, sys.argv[3])
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
