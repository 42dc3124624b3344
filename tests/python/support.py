"""Helpers of the tests of the Python package. Tests run with LAB_BIN (folder of the programs), LAB_ROOT
(folder of the sources) and PYTHONPATH (folder of active_lab) in the environment."""
import importlib
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BIN = Path(os.environ["LAB_BIN"])
ROOT = Path(os.environ["LAB_ROOT"])
SKIPPED = 77


def lab(*arguments, cwd=None, expect=0, timeout=600):
    """Runs a command of `lab` and gives its output."""
    done = subprocess.run([BIN / "lab", *map(str, arguments)], cwd=cwd, text=True, timeout=timeout,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode != expect:
        raise AssertionError(f"lab {' '.join(map(str, arguments))}: exit code {done.returncode}, "
                             f"expected {expect}\n{done.stdout}")
    return done.stdout


def run_node(*arguments):
    """Runs JavaScript, without the library of a sanitizer, which reports what node itself does."""
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    return subprocess.run(["node", *arguments], capture_output=True, text=True, env=environment)


def experiment(name):
    return ROOT / "experiments" / f"{name}.toml"


def virtual_run(folder, name, *options, report=False):
    """Runs a shipped experiment in virtual time; returns the folder of the run."""
    before = set(Path(folder).glob("*"))
    lab("run", experiment(name), "--virtual-time", "--runs", folder, *([] if report else ["--no-report"]), *options)
    (made,) = set(Path(folder).glob("*")) - before
    return made


def lcm_types(folder):
    """The message classes that LCM's own lcm-gen makes: a reader that shares no code with the package."""
    subprocess.run(["lcm-gen", "-p", "--ppath", str(folder), *map(str, sorted((ROOT / "lcmtypes").glob("*.lcm")))],
                   check=True, stdout=subprocess.DEVNULL)
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module("lab")
    finally:
        sys.path.pop(0)


def lcm_events(log):
    """(channel, arrival, message) of every event of a log, by docs/formats.md."""
    import struct

    data = Path(log).read_bytes()
    at = 0
    while at < len(data):
        _, _, utime, channel, size = struct.unpack_from(">IqqII", data, at)
        name = data[at + 28:at + 28 + channel].decode()
        yield name, utime, data[at + 28 + channel:at + 28 + channel + size]
        at += 28 + channel + size


class RunTestCase(unittest.TestCase):
    """Tests of one run, which is made once: light_switching, 40 s, with a report."""

    NAME = "light_switching"
    OPTIONS = ("--set", "duration_s=40", "--set", "light.steps[0].hold_s=10", "--set", "light.steps[1].hold_s=10",
               "--set", "light.steps[2].hold_s=20")
    REPORT = True

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="lab_python_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.path = virtual_run(cls.folder / "runs", cls.NAME, *cls.OPTIONS, report=cls.REPORT)
        cls.log = cls.path / "log.lcmlog"


def main():
    unittest.main(verbosity=2)
