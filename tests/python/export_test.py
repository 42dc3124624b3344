"""`lab export`: each reader of another maker finds the numbers of the run."""
import json
import lzma
import math
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import h5py
import numpy
import pandas

import active_lab
from support import ROOT, SKIPPED, RunTestCase, lab, lcm_events, main, run_node, virtual_run

JAVASCRIPT = ROOT / "tests" / "python" / "mcap_reader"


class Exports(RunTestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.printed = lab("export", cls.path, "--mcap", "--hdf5", "--csv", "--trackpy", "--trex")
        cls.run_ = active_lab.open(cls.path)
        cls.beside = cls.path.parent
        cls.name = cls.path.name

    def file(self, ending):
        return self.beside / (self.name + ending)

    def assert_tables_equal(self, ours, theirs, where):
        self.assertEqual(list(ours.columns), list(theirs.columns), where)
        self.assertEqual(len(ours), len(theirs), where)
        for name in ours.columns:
            mine = ours[name].to_numpy()
            other = theirs[name].to_numpy()
            if ours[name].dtype == "category":
                mine = mine.astype(str)
                other = numpy.array([text.decode() if isinstance(text, bytes) else text for text in other], dtype=str)
            numpy.testing.assert_array_equal(mine, other, f"{where}.{name}")

    def tables(self):
        listed = self.run_.tables
        return zip(listed.channel, listed.path)

    def test_h5py_finds_every_number_of_every_table(self):
        with h5py.File(self.file(".h5")) as file:
            for channel, path in self.tables():
                name = f"{channel}/{path.replace('.', '_') or 'messages'}"
                table = self.run_.table(channel, path)
                self.assert_tables_equal(table, pandas.DataFrame(file[name][:]), name)
                self.assertEqual(json.loads(file[name].attrs["units"]), table.attrs["units"], name)
            self.assertIn(b"light_switching", file.attrs["experiment"])  # h5py gives bytes
            self.assertEqual(int(file.attrs["start_utime"]), self.run_.start_utime)
            self.assertEqual(file["poses"], file["TRACKED_FRAME/robots"])

    def test_pandas_reads_the_tables_by_name(self):
        poses = pandas.read_hdf(self.file(".h5"), "poses")
        numpy.testing.assert_array_equal(poses.x, self.run_.poses.x)
        numpy.testing.assert_array_equal(poses.robot_id, self.run_.poses.robot_id)
        events = pandas.read_hdf(self.file(".h5"), "events")
        self.assertGreater(len(events), 5)
        with h5py.File(self.file(".h5")) as file:
            self.assertEqual(file["analysis"], file["ANALYSIS/estimates"])
            self.assertEqual(file["collective"], file["COLLECTIVE/observables"])

    def test_csv_has_every_number_of_every_table(self):
        for channel, path in self.tables():
            file = self.file("-csv") / (f"{channel}.{path}.csv" if path else f"{channel}.csv")
            table = self.run_.table(channel, path)
            texts = {name: str for name in table.columns if table[name].dtype == "category"}
            read = pandas.read_csv(file, dtype=texts, keep_default_na=False, float_precision="round_trip",
                                   na_values={name: ["nan"] for name in table.columns if name not in texts})
            for name in table.columns:
                if name not in texts:
                    read[name] = read[name].astype(table[name].dtype)
            self.assert_tables_equal(table, read, file.name)
        columns = pandas.read_csv(self.file("-csv") / "columns.csv")
        unit = columns[(columns.table == "TRACKED_FRAME.robots") & (columns.column == "x")].unit
        self.assertEqual(list(unit), ["m"])

    def test_trackpy_and_trex_have_the_poses(self):
        poses = self.run_.poses
        trackpy = pandas.read_csv(self.file("-trackpy.csv"))
        numpy.testing.assert_allclose(trackpy.x, 100 * poses.x, rtol=1e-12)
        numpy.testing.assert_array_equal(trackpy.particle, poses.robot_id)
        numpy.testing.assert_allclose(trackpy.t, poses.t, atol=1e-9)
        for robot in poses.robot_id.unique():
            own = poses[poses.robot_id == robot]
            trex = pandas.read_csv(self.file("-trex") / f"{self.name}_id{robot}.csv", float_precision="round_trip")
            self.assertEqual(len(trex), poses.frame.nunique())
            seen = trex[trex.missing == 0]
            numpy.testing.assert_allclose(seen["X#wcentroid (cm)"], 100 * own.x, rtol=1e-12)
            numpy.testing.assert_array_equal(seen.ANGLE, own.theta)

    def test_poses_that_the_report_refuses_are_in_no_export_of_poses(self):
        log = self.folder / "two_bits.lcmlog"
        log.write_bytes(lzma.decompress((ROOT / "tests" / "system" / "damage" / "logs" / "two_bits.lcmlog.xz").read_bytes()))
        lab("export", log, "--trackpy", "--trex", "--out", self.folder / "two_bits")
        trackpy = pandas.read_csv(self.folder / "two_bits" / "two_bits-trackpy.csv")
        self.assertLess(trackpy.t.max(), 1e4)
        self.assertEqual(len(trackpy), len(active_lab.open(log).poses))
        for file in (self.folder / "two_bits" / "two_bits-trex").glob("*.csv"):
            self.assertLess(pandas.read_csv(file).time.max(), 1e4)

    def test_a_run_with_recorded_frame_times_has_no_film(self):
        frames = self.folder / "recorded.csv"
        frames.write_text("t_s,missing\n" + "".join(f"{0.1 * i:.1f},\n" for i in range(20)))
        run = virtual_run(self.folder / "framed", "abp", "--set", "duration_s=2", "--set", f"camera.frames={frames}")
        self.assertEqual(active_lab.open(run).films, [])
        lab("export", run, "--mcap")

    def test_analyze_takes_mcap_and_hdf5_back(self):
        out = {}
        for source in (self.path, self.file(".mcap"), self.file(".h5")):
            out[source] = self.folder / ("report_of" + source.suffix)
            lab("analyze", source, "--no-bootstrap", "--no-figures", "--out", out[source])
        reference = out[self.path]
        for folder in list(out.values())[1:]:
            for name in ("summary.json", "trajectories.csv", "segments.csv"):
                self.assertEqual((folder / name).read_bytes(), (reference / name).read_bytes(), (folder, name))
            self.assertEqual([], list(folder.glob(".import*")))

    def test_removed_poses_stay_removed(self):
        edited = self.folder / "edited.h5"
        shutil.copy(self.file(".h5"), edited)
        with h5py.File(edited, "r+") as file:
            robots = file["TRACKED_FRAME/robots"]
            kept = robots[:][robots["robot_id"] != 2]
            robots.resize((len(kept),))
            robots[:] = kept
        lab("analyze", edited, "--no-bootstrap", "--no-figures", "--out", self.folder / "edited")
        report = pandas.read_csv(self.folder / "edited" / "trajectories.csv")
        self.assertEqual(set(report.particle), set(self.run_.poses.robot_id) - {2})

    def test_poses_of_pandas_are_analyzed_like_csv(self):
        poses = self.run_.poses
        table = pandas.DataFrame({"frame": poses.frame, "id": poses.robot_id, "x_cm": 100 * poses.x,
                                  "y_cm": 100 * poses.y, "theta_rad": poses.theta, "t_s": poses.t})
        table.to_hdf(self.folder / "poses.h5", "poses", format="table", data_columns=True)
        table.to_csv(self.folder / "poses.csv", index=False)
        for name in ("poses.h5", "poses.csv"):
            lab("analyze", self.folder / name, "--no-bootstrap", "--no-figures", "--out",
                self.folder / ("own" + name[-4:]))
        self.assertEqual((self.folder / "own.csv" / "trajectories.csv").read_bytes(),
                         (self.folder / "owns.h5" / "trajectories.csv").read_bytes())

    def test_no_file_is_attached_to_which_the_folder_of_a_run_links(self):
        folder = self.beside / "with_link"
        shutil.copytree(self.path, folder)
        self.addCleanup(shutil.rmtree, folder)
        secret = self.beside / "secret"
        secret.write_text("what nobody else may read")
        (folder / "provenance.json").unlink()
        (folder / "provenance.json").symlink_to(secret)
        lab("export", folder, "--mcap", "--out", folder)
        written = (folder / "with_link.mcap").read_bytes()
        self.assertIn((folder / "summary.json").read_bytes(), written)
        self.assertNotIn(secret.read_bytes(), written)

    def test_no_film_is_exported_to_which_the_folder_of_a_run_links(self):
        folder = self.beside / "with_film"
        shutil.copytree(self.path, folder)
        self.addCleanup(shutil.rmtree, folder)
        private = self.beside / "private.mkv"
        subprocess.run(["ffmpeg", "-hide_banner", "-loglevel", "error", "-y", "-f", "lavfi", "-i",
                        "testsrc=size=64x48:rate=5:duration=1", str(private)], check=True)
        (folder / "film.mkv").symlink_to(private)
        output = lab("export", folder, "--mcap", "--out", folder)
        self.assertIn("film.mkv leads out of the folder of the run and is left out", output)
        self.assertNotIn("pictures of", output)
        output = lab("export", folder, "--mcap", "--out", folder, "--force", "--film", private)
        self.assertIn("with 5 pictures of", output)
        (folder / "film.mkv").unlink()
        (folder / "pictures").mkdir()
        (folder / "pictures" / "frames.csv").write_text("frame,t_s\n1,0\n2,1\n")
        subprocess.run(["ffmpeg", "-hide_banner", "-loglevel", "error", "-i", str(private), "-frames:v", "2",
                        str(self.beside / "f%d.png")], check=True)
        for name in ("f1.png", "f2.png"):
            (folder / "pictures" / name).symlink_to(self.beside / name)
        output = lab("export", folder, "--mcap", "--out", folder, "--force")
        self.assertIn("pictures leads out of the folder of the run and is left out", output)

    def test_nothing_is_replaced_without_force(self):
        output = lab("export", self.path, "--hdf5", expect=2)
        self.assertIn("is there already", output)
        lab("export", self.path, "--trackpy", "--force")
        self.assertIn("found no format", lab("export", self.path, expect=2))
        self.assertIn("no such file", lab("export", self.folder / "nothing", "--csv", expect=2))


class Mcap(RunTestCase):
    """Read by @mcap/core and @foxglove/rosmsg2-serialization, which Foxglove and Lichtblick use."""

    REPORT = False

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        modules = Path(os.environ["LAB_NODE"])
        lab("export", cls.path, "--mcap")
        done = run_node(modules / "read.mjs", f"{cls.path}.mcap")
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        cls.head = lines[0]
        cls.messages = lines[1:]
        cls.run_ = active_lab.open(cls.path)

    def on(self, topic):
        return [entry for entry in self.messages if entry["topic"] == topic]

    def test_every_field_of_every_message_is_that_of_the_log(self):
        theirs = [entry for entry in self.messages if entry["topic"].startswith("/bus/")]
        count = 0
        for (channel, utime, message), entry in zip(active_lab.Log(self.log).messages(), theirs):
            self.assertEqual(entry["topic"], "/bus/" + channel)
            self.assertEqual(entry["logTime"], str(utime * 1000))
            self.assertEqual(entry["publishTime"], str(message.utime * 1000))
            difference = differs(message.to_dict(), entry["message"], channel)
            self.assertIsNone(difference)
            count += 1
        self.assertEqual(count, len(theirs))
        self.assertEqual(count, sum(1 for _ in lcm_events(self.log)))

    def test_poses_of_ros_are_those_of_the_tracker(self):
        poses = self.run_.poses
        for robot in (1, 4):
            own = poses[poses.robot_id == robot]
            theirs = self.on(f"/lab/robot{robot}/pose")
            self.assertEqual(len(theirs), len(own))
            x = [entry["message"]["pose"]["position"]["x"] for entry in theirs]
            numpy.testing.assert_array_equal(x, own.x)
            angle = [2 * math.atan2(entry["message"]["pose"]["orientation"]["z"],
                                    entry["message"]["pose"]["orientation"]["w"]) for entry in theirs]
            numpy.testing.assert_allclose(angle, own.theta, atol=1e-12)
            stamp = theirs[7]["message"]["header"]["stamp"]
            self.assertAlmostEqual(stamp["sec"] + stamp["nanosec"] / 1e9 - self.run_.start_utime / 1e6,
                                   own.t.iloc[7], places=6)
        transforms = self.on("/tf")
        self.assertEqual(len(transforms), poses.frame.nunique())
        self.assertEqual(transforms[0]["message"]["transforms"][0]["header"]["frame_id"], "lab/arena")
        self.assertEqual(transforms[0]["message"]["transforms"][1]["child_frame_id"], "lab/robot2")
        self.assertEqual(len(self.on("/lab/poses")[0]["message"]["poses"]), poses.robot_id.nunique())

    def test_the_light_field_is_that_of_the_run(self):
        grids = self.on("/lab/light_field")
        self.assertGreaterEqual(len(grids), 3)
        info = grids[-1]["message"]["info"]
        self.assertEqual((info["width"], info["height"]), (120, 90))
        self.assertEqual({round(value) for value in grids[-1]["message"]["data"]}, {90})

    def test_indices_and_attachments_are_complete(self):
        self.assertEqual(self.head["profile"], "ros2")
        self.assertEqual(self.head["statistics"]["messageCount"], str(len(self.messages)))
        self.assertEqual(self.head["indexed"], len(self.messages))
        self.assertIn("experiment.toml", self.head["attachments"])
        self.assertIn("light_switching", self.head["attachments"]["experiment.toml"])

    def test_schemas_have_units(self):
        self.assertIn("float64 wheel_left  # [m/s]", self.head["schemas"]["active_lab_bus/msg/RobotStatus"])
        self.assertIn("int8 SIM=2", self.head["schemas"]["active_lab_bus/msg/RobotStatus"])


def differs(ours, theirs, where):
    """Where a message of ours differs from one that JavaScript has read; None: nowhere."""
    if isinstance(ours, dict):
        if ours.keys() != theirs.keys():
            return f"{where}: {sorted(theirs)}"
        return next((found for key in ours if (found := differs(ours[key], theirs[key], f"{where}.{key}"))), None)
    if isinstance(ours, (list, bytes)):
        if len(ours) != len(theirs):
            return f"{where}: {len(theirs)} elements"
        return next((found for i in range(len(ours)) if (found := differs(ours[i], theirs[i], f"{where}[{i}]"))), None)
    if isinstance(ours, float) and math.isnan(ours):
        return None if theirs == "NaN" else f"{where}: {theirs}"
    if isinstance(ours, float) and math.isinf(ours):
        theirs = float(theirs) if theirs in ("Infinity", "-Infinity") else theirs
    if isinstance(ours, int) and isinstance(theirs, str):
        theirs = int(theirs)  # int64 is a BigInt there
    return None if ours == theirs else f"{where}: {ours!r}, there {theirs!r}"


if __name__ == "__main__":
    if "Mcap" in sys.argv[1:]:
        if shutil.which("node") is None or not (Path(os.environ["LAB_NODE"]) / "node_modules").exists():
            print("skipped: node, or the packages of tests/python/mcap_reader/package.json, are not installed"
                  " (npm ci in the build)")
            sys.exit(SKIPPED)
    main()
