"""`lab analyze FILE.h5` of files that a user has written with h5py, by the table in docs/formats.md."""
import shutil
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy
import pandas

from support import RunTestCase, lab, main


def two_robots():
    """Poses of two robots for 20 s at 10 frames/s: one on a circle, one on a line."""
    t = numpy.arange(200) / 10
    circle = pandas.DataFrame({"frame": numpy.arange(200), "id": 1, "t_s": t, "x_cm": 60 + 10 * numpy.cos(0.3 * t),
                               "y_cm": 45 + 10 * numpy.sin(0.3 * t), "theta_rad": 0.3 * t + numpy.pi / 2})
    line = pandas.DataFrame({"frame": numpy.arange(200), "id": 2, "t_s": t, "x_cm": 20 + 3 * t, "y_cm": 20.0,
                             "theta_rad": 0.0})
    return pandas.concat([circle, line]).sort_values(["frame", "id"], kind="stable").reset_index(drop=True)


class HandMade(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="lab_python_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.table = two_robots()
        cls.table.to_csv(cls.folder / "poses.csv", index=False)
        cls.reference = cls.analyzed(cls.folder / "poses.csv")

    @classmethod
    def analyzed(cls, file):
        out = cls.folder / ("report_of_" + file.name)
        lab("analyze", file, "--no-bootstrap", "--no-figures", "--out", out)
        return (out / "trajectories.csv").read_bytes()

    def written(self, name, **datasets):
        with h5py.File(self.folder / name, "w") as file:
            for key, values in datasets.items():
                file[key.replace("__", "/")] = values
        return self.folder / name

    def refusal(self, file):
        text = lab("analyze", file, "--out", self.folder / "refused", expect=2).strip()
        self.assertEqual(len(text.splitlines()), 1, text)
        self.assertIn(file.name, text)
        return text

    def columns(self):
        return {name: self.table[name].to_numpy() for name in self.table.columns}

    def test_every_documented_layout_gives_the_report_of_the_csv(self):
        self.assertGreater(len(self.reference), 5000)
        layouts = {
            "records.h5": {"poses": self.table.to_records(index=False)},
            "other_name.h5": {"mine": self.table.to_records(index=False), "comment": "by hand"},
            "lists.h5": {f"poses__{name}": values for name, values in self.columns().items()},
            "root.h5": self.columns(),
        }
        for name, datasets in layouts.items():
            self.assertEqual(self.analyzed(self.written(name, **datasets)), self.reference, name)

    def test_small_and_packed_numbers_and_other_groups_do_no_harm(self):
        with h5py.File(self.folder / "packed.h5", "w") as file:
            for name, values in self.columns().items():
                kind = "u1" if name in ("frame", "id") else "f8"
                file.create_dataset(f"poses/{name}", data=values.astype(kind), compression="gzip", chunks=(64,))
            file["poses/remark"] = "written by hand"
            file["poses/picture"] = numpy.zeros((3, 3))
            file["settings/gain"] = 3.0
        self.assertEqual(self.analyzed(self.folder / "packed.h5"), self.reference)

    def test_what_is_wrong_is_said_in_one_line(self):
        columns = {f"poses__{name}": values for name, values in self.columns().items()}
        short = dict(columns, poses__y_cm=self.table.y_cm.to_numpy()[:-1])
        self.assertIn("found 400 numbers in poses/frame and 399 in poses/y_cm, expected as many",
                      self.refusal(self.written("short.h5", **short)))
        no_x = {name: values for name, values in columns.items() if "x_cm" not in name}
        self.assertIn('no_x.h5:1: found the columns "frame", "id", "t_s", "theta_rad", "y_cm"; expected frame',
                      self.refusal(self.written("no_x.h5", **no_x)))
        self.assertIn("found poses without names of columns, expected",
                      self.refusal(self.written("matrix.h5", poses=self.table.to_numpy())))
        self.assertIn("found no list of numbers in the group poses, expected",
                      self.refusal(self.written("text.h5", poses__names="a, b")))
        self.assertIn("found 0 tables of records, expected",
                      self.refusal(self.written("other.h5", pictures=numpy.zeros((4, 4)))))


class HandMadeLog(RunTestCase):
    """A log of which somebody has copied only some channels, with h5py's own texts."""

    REPORT = False
    OPTIONS = ("--set", "duration_s=10")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        lab("export", cls.path, "--hdf5")
        cls.export = cls.path.parent / (cls.path.name + ".h5")

    def copied(self, name, tables):
        with h5py.File(self.export) as source, h5py.File(self.folder / name, "w") as file:
            for table in tables:
                file[table] = source[table][:]
                if table.endswith("/messages"):
                    file[table].attrs["type"] = table.split("/")[0].lower() + "_t"
        return self.folder / name

    def analyzed(self, file):
        out = self.folder / ("report_of_" + file.name)
        lab("analyze", file, "--no-bootstrap", "--no-figures", "--out", out)
        return pandas.read_csv(out / "trajectories.csv")

    def test_channels_and_lists_may_be_missing(self):
        whole = self.analyzed(self.export)
        poses = self.analyzed(self.copied("poses.h5", ["TRACKED_FRAME/messages", "TRACKED_FRAME/robots"]))
        for name in ("particle", "x", "y", "theta"):
            numpy.testing.assert_array_equal(poses[name], whole[name], name)
        some = self.copied("some.h5", ["TRACKED_FRAME/messages", "TRACKED_FRAME/robots", "ROBOT_STATUS/messages"])
        self.assertEqual(len(self.analyzed(some)), len(whole))

    def test_a_missing_column_is_named(self):
        file = self.copied("poses.h5", ["TRACKED_FRAME/messages"])
        with h5py.File(self.export) as source, h5py.File(file, "r+") as edited:
            robots = pandas.DataFrame(source["TRACKED_FRAME/robots"][:]).drop(columns="theta")
            edited["TRACKED_FRAME/robots"] = robots.to_records(index=False)
        text = lab("analyze", file, "--out", self.folder / "refused", expect=2)
        self.assertIn("/TRACKED_FRAME/robots has no column theta; expected the tables that lab export --hdf5 makes", text)


if __name__ == "__main__":
    main()
