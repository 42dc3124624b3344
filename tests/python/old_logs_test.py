"""Logs of older versions of the messages are converted while they are read, as for the report."""
import importlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import active_lab
from support import ROOT, main


class OldLogs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="lab_python_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        definitions = sorted((ROOT / "lcmtypes" / "v4").glob("*.lcm"))
        subprocess.run(["lcm-gen", "-p", "--ppath", str(cls.folder), *map(str, definitions)], check=True,
                       stdout=subprocess.DEVNULL)
        sys.path.insert(0, str(cls.folder))
        cls.old = importlib.import_module("lab_v4")
        sys.path.pop(0)

    def log_of(self, *events):
        file = self.folder / f"{self.id()}.lcmlog"
        with open(file, "wb") as log:
            for number, (channel, message) in enumerate(events):
                encoding = message.encode()
                name = channel.encode()
                log.write(struct.pack(">IqqII", 0xEDA1DA01, number, 1000 + number, len(name), len(encoding)))
                log.write(name + encoding)
        return active_lab.open(file)

    def test_truth_of_version_4_is_that_of_today(self):
        truth = self.old.sim_truth_t()
        truth.utime, truth.sender, truth.seq, truth.num_robots = 1_000_000, "sim_svc", 1, 2
        for robot_id in (1, 2):
            pose = self.old.true_pose_t()
            pose.robot_id, pose.x, pose.y, pose.theta = robot_id, 0.25 * robot_id, 0.5, 7.0
            truth.robots.append(pose)

        run = self.log_of(("SIM_TRUTH", truth))

        self.assertEqual(run.type_of("SIM_TRUTH"), "sim_truth_t")
        self.assertEqual(list(run.truth.x), [0.25, 0.5])
        self.assertEqual(list(run.truth.theta), [7.0, 7.0])
        message = next(run.messages("SIM_TRUTH")).message
        self.assertIsInstance(message, active_lab.messages.sim_truth_t)

    def test_an_unknown_type_is_counted_and_left_out(self):
        class Foreign:
            def encode(self):
                return bytes(20)

        truth = self.old.sim_truth_t()
        truth.sender = "sim_svc"
        run = self.log_of(("SIM_TRUTH", truth), ("OTHER", Foreign()))

        self.assertEqual(run.channels.loc["OTHER", "messages"], 1)
        self.assertIsNone(run.channels.loc["OTHER", "type"])
        self.assertNotIn("OTHER", run)
        self.assertEqual([message.channel for message in run.messages()], ["SIM_TRUTH"])


if __name__ == "__main__":
    main()
