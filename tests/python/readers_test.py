"""Every reader finds the same numbers in one run: LCM's own Python, the package, CSV, HDF5 (h5py and pandas), MCAP
(the libraries of Foxglove), trackpy's and TRex's tables, and the report."""
import json
import os
import shutil
from pathlib import Path

import h5py
import numpy
import pandas

import active_lab
from support import RunTestCase, lab, lcm_events, lcm_types, main, run_node

POSES = ["utime", "robot_id", "x", "y", "theta"]
STATES = ["utime", "robot_id", "battery", "wheel_left", "wheel_right"]
ESTIMATES = ["utime", "name", "value", "sigma"]


def rows(channel, messages):
    """Poses, states or estimates of messages: attributes of LCM's objects, or JSON of other readers."""
    get = (lambda part, name: part[name]) if isinstance(messages[0], dict) else getattr
    table = []
    for message in messages:
        utime = int(get(message, "utime"))
        for one in get(message, "estimates" if channel == "ANALYSIS" else "robots"):
            table.append((utime, *(get(one, name) for name in COLUMNS[channel][1:])))
    numbers = {name: numpy.float32 if name == "battery" else float for name in COLUMNS[channel][1:] if name not in ("robot_id", "name")}
    return pandas.DataFrame(table, columns=COLUMNS[channel]).astype(numbers)


COLUMNS = {"TRACKED_FRAME": POSES, "ROBOT_STATUS": STATES, "ANALYSIS": ESTIMATES}
LISTS = {"TRACKED_FRAME": "robots", "ROBOT_STATUS": "robots", "ANALYSIS": "estimates"}


class Readers(RunTestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        lab("export", cls.path, "--mcap", "--hdf5", "--csv", "--trackpy", "--trex")
        types = lcm_types(cls.folder / "types")
        cls.reference = {}
        for channel in COLUMNS:
            decode = getattr(types, f"{channel.lower()}_t").decode
            messages = [decode(data) for name, _, data in lcm_events(cls.log) if name == channel]
            cls.reference[channel] = rows(channel, messages)

    def file(self, ending):
        return self.path.parent / (self.path.name + ending)

    def assert_same(self, channel, theirs, reader):
        ours = self.reference[channel]
        self.assertGreater(len(ours), 20, channel)
        self.assertEqual(len(ours), len(theirs), (channel, reader))
        theirs = theirs.astype({"battery": numpy.float32} if "battery" in ours else {})  # CSV does not say so
        for name in ours.columns:
            other = theirs[name].to_numpy()
            if ours[name].dtype == object:
                other = numpy.array([text.decode() if isinstance(text, bytes) else text for text in other], object)
            numpy.testing.assert_array_equal(ours[name].to_numpy(), other, f"{reader}: {channel}.{name}")

    def test_the_package(self):
        run = active_lab.open(self.path)
        for channel, path in LISTS.items():
            self.assert_same(channel, run.table(channel, path), "active_lab.open")
            messages = [message for _, _, message in active_lab.Log(self.log).messages(channel)]
            self.assert_same(channel, rows(channel, messages), "active_lab.Log")

    def test_csv(self):
        for channel, path in LISTS.items():
            table = pandas.read_csv(self.file("-csv") / f"{channel}.{path}.csv", float_precision="round_trip")
            self.assert_same(channel, table, "CSV")

    def test_hdf5(self):
        with h5py.File(self.file(".h5")) as file:
            for channel, path in LISTS.items():
                self.assert_same(channel, pandas.DataFrame(file[f"{channel}/{path}"][:]), "h5py")
        self.assert_same("TRACKED_FRAME", pandas.read_hdf(self.file(".h5"), "poses"), "pandas")

    def test_mcap(self):
        modules = Path(os.environ["LAB_NODE"])
        if shutil.which("node") is None or not (modules / "node_modules").exists():
            self.skipTest("node or the packages of tests/python/mcap_reader are not installed")
        done = run_node(modules / "read.mjs", self.file(".mcap"))
        self.assertEqual(done.returncode, 0, done.stderr)
        messages = {channel: [] for channel in COLUMNS}
        for line in done.stdout.splitlines()[1:]:
            entry = json.loads(line)
            if (channel := entry["topic"].removeprefix("/bus/")) in messages:
                messages[channel].append(entry["message"])
        for channel in COLUMNS:
            self.assert_same(channel, rows(channel, messages[channel]), "MCAP")

    def test_tables_of_poses(self):
        poses = self.reference["TRACKED_FRAME"].sort_values(["utime", "robot_id"], kind="stable")
        trackpy = pandas.read_csv(self.file("-trackpy.csv"), float_precision="round_trip")
        trackpy = trackpy.sort_values(["frame", "particle"], kind="stable")
        report = pandas.read_csv(self.path / "trajectories.csv", float_precision="round_trip")
        report = report.sort_values(["frame", "particle"], kind="stable")
        for reader, table in (("trackpy", trackpy), ("report", report)):
            self.assertEqual(len(table), len(poses), reader)
            numpy.testing.assert_array_equal(table.particle, poses.robot_id, reader)
            for name in ("x", "y"):
                numpy.testing.assert_allclose(table[name], 100 * poses[name], rtol=0, atol=1e-4, err_msg=reader)
        numpy.testing.assert_allclose(trackpy.x, 100 * poses.x, rtol=1e-15)
        numpy.testing.assert_array_equal(trackpy.theta, poses.theta)
        for robot in poses.robot_id.unique():
            own = poses[poses.robot_id == robot]
            trex = pandas.read_csv(self.file("-trex") / f"{self.path.name}_id{robot}.csv",
                                   float_precision="round_trip")
            numpy.testing.assert_allclose(trex[trex.missing == 0]["X#wcentroid (cm)"], 100 * own.x, rtol=1e-15)


if __name__ == "__main__":
    main()
