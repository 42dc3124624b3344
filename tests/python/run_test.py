"""A run as tables: every number is that of LCM's own decoder, of the report, and of the truth."""
import functools
import lzma
import math
import os
import pathlib
import re
import resource
import struct
import unittest

import numpy
import pandas

import active_lab
from active_lab import messages
from support import ROOT, RunTestCase, lcm_events, lcm_types, main


def plain(value):
    """A message of lcm-gen's classes, or a field of one, as dicts, lists and numbers."""
    if hasattr(value, "__slots__"):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, (list, tuple)):
        return [plain(element) for element in value]
    return value


def equal(ours, theirs):
    if isinstance(ours, dict):
        return ours.keys() == theirs.keys() and all(equal(ours[key], theirs[key]) for key in ours)
    if isinstance(ours, list):
        return len(ours) == len(theirs) and all(map(equal, ours, theirs))
    if isinstance(ours, float) and math.isnan(ours):
        return isinstance(theirs, float) and math.isnan(theirs)
    return ours == theirs


class Messages(RunTestCase):
    REPORT = False

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.theirs = lcm_types(cls.folder / "lcm")

    def decoded(self):
        """(channel, arrival, message of lcm-gen's class)"""
        types = {struct.unpack(">q", getattr(self.theirs, name)._get_packed_fingerprint())[0]: getattr(self.theirs, name)
                 for name in active_lab.messages.types}
        for channel, utime, message in lcm_events(self.log):
            yield channel, utime, types[struct.unpack(">q", message[:8])[0]].decode(message)

    def test_every_field_of_every_message_is_that_of_lcm_gen(self):
        ours = active_lab.Log(self.log).messages()
        count = 0
        for channel, utime, theirs in self.decoded():
            mine = next(ours)
            self.assertEqual((mine.channel, mine.received_utime), (channel, utime))
            self.assertTrue(equal(mine.message.to_dict(), plain(theirs)), channel)
            count += 1
        self.assertIsNone(next(ours, None))
        self.assertGreater(count, 5000)

    def test_messages_are_encoded_as_lcm_gen_encodes_them(self):
        seen = set()
        for (channel, _, message), (_, _, encoding) in zip(active_lab.Log(self.log).messages(), lcm_events(self.log)):
            if channel not in seen:
                self.assertEqual(message.encode(), encoding, channel)
                seen.add(channel)
        self.assertGreater(len(seen), 8)

    def test_every_field_of_every_table_is_that_of_lcm_gen(self):
        log = active_lab.Log(self.log)
        expected = {}
        for number, (channel, utime, message) in enumerate(self.decoded()):
            rows_of(message, channel, "", {"event": number, "received_utime": utime}, expected)
        compared = 0
        for channel, path in zip(log.tables.channel, log.tables.path):
            table = log.table(channel, path)
            rows = expected.get((channel, path), [])
            self.assertEqual(len(table), len(rows), (channel, path))
            for name in rows[0] if rows else ():
                values = table[name].to_list()
                for mine, row in zip(values, rows):
                    theirs = row[name]
                    if isinstance(theirs, float) and theirs != theirs:
                        self.assertTrue(mine != mine)
                    else:
                        self.assertEqual(mine, theirs, (channel, path, name))
                    compared += 1
        self.assertGreater(compared, 100_000)


@functools.lru_cache(maxsize=None)
def dimension_of(type_name, field):
    """What stands in the brackets behind a field in its definition; None: it has none."""
    text = (ROOT / "lcmtypes" / f"{type_name}.lcm").read_text()
    found = re.search(rf"^  \w+ {field}(?:\[(\w+)\])?;", text, re.M)
    return found.group(1)


def rows_of(message, channel, path, above, tables, prefix="", row=None):
    """The rows that a message of lcm-gen's class makes in the tables, by the names of its fields alone."""
    top = row is None
    if top:
        row = dict(above)
        tables.setdefault((channel, path), []).append(row)
    counts = {name: getattr(message, name) for name in message.__slots__ if name.startswith("num_") or name == "size"}
    lists = {}
    for name in message.__slots__:
        value = getattr(message, name)
        dimension = dimension_of(type(message).__name__, name)
        if dimension is None and hasattr(value, "__slots__"):
            rows_of(value, channel, path, above, tables, prefix + name + "_", row)
        elif dimension is None:
            row[prefix + name] = value
        elif dimension.isdigit():
            elements = ["xx", "xy", "xt", "yy", "yt", "tt"] if name == "covariance" else map(str, range(len(value)))
            for element, number in zip(elements, value):
                row[f"{prefix}{name}_{element}"] = number
        else:
            lists.setdefault(dimension, []).append((name, value))
    for count, fields in lists.items():
        name = fields[0][0] if len(fields) == 1 else count[len("num_"):]
        below = (path + "." if path else "") + prefix + name
        inner = {key: above[key] for key in ("event", "received_utime")}
        for i in range(counts[count]):
            if hasattr(fields[0][1][i], "__slots__"):
                rows_of(fields[0][1][i], channel, below, inner, tables)
            else:
                tables.setdefault((channel, below), []).append({**inner, **{field: value[i] for field, value in fields}})


class Tables(RunTestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_ = active_lab.open(cls.path)

    def test_poses_are_those_of_the_report(self):
        report = self.run_.trajectories
        poses = self.run_.poses
        self.assertEqual(len(poses), len(report))
        ours = poses.sort_values(["frame", "robot_id"], kind="stable").reset_index(drop=True)
        theirs = report.sort_values(["frame", "particle"], kind="stable").reset_index(drop=True)
        numpy.testing.assert_array_equal(ours.frame, theirs.frame)
        numpy.testing.assert_array_equal(ours.robot_id, theirs.particle)
        numpy.testing.assert_allclose(ours.t, theirs.t, atol=0.6e-6)
        for axis in "xy":
            numpy.testing.assert_allclose(ours[axis] * 100, theirs[axis], atol=0.6e-4)  # four decimals of cm
        numpy.testing.assert_allclose(ours.theta, theirs.theta, atol=0.6e-6)

    def test_tables_say_units_and_meanings(self):
        self.assertEqual(self.run_.poses.attrs["units"]["x"], "m")
        self.assertEqual(self.run_.poses.attrs["units"]["t"], "s")
        self.assertEqual(self.run_.states.attrs["units"]["battery"], "V")
        self.assertEqual(self.run_.table("TRACKED_FRAME", "robots").attrs["units"]["covariance_xt"], "m rad")
        self.assertEqual(self.run_.states.attrs["values"]["origin"][2], "SIM")

    def test_tracked_poses_lie_beside_the_truth(self):
        truth = self.run_.truth
        poses = self.run_.poses
        both = poses.assign(t=poses.t.round(6)).merge(truth.assign(t=truth.t.round(6)), on=["t", "robot_id"],
                                                      suffixes=("", "_true"))
        self.assertGreater(len(both), 500)
        self.assertLess(float(numpy.hypot(both.x - both.x_true, both.y - both.y_true).mean()), 1e-3)

    def test_states_name_the_programs_by_light(self):
        states = self.run_.states
        last = states[(states.t > 38) & (states.t < 40) & (states.robot_id == 1)]
        self.assertEqual(set(last.program_name), {"rtp"})

    def test_events_are_the_steps_of_the_script(self):
        events = self.run_.events
        steps = events[events.kind == "STEP"]
        self.assertEqual(list(steps.label), ["dim: BP", "half: ABP", "bright: RTP"])
        numpy.testing.assert_allclose(steps.presented_t, [0, 10, 20], atol=0.05)
        self.assertEqual((events.kind == "START").sum(), 1)
        self.assertEqual((events.kind == "END").sum(), 1)

    def test_analysis_has_the_estimates_of_the_summary(self):
        analysis = self.run_.analysis
        last = analysis[(analysis.robot_id == -1) & (analysis.program == "rtp")].groupby("name", observed=True).last()
        self.assertIn("v", last.index)
        self.assertAlmostEqual(float(last.loc["v", "value"]), 0.05, delta=0.002)
        curves = self.run_.curves
        self.assertEqual(set(curves.name), {"msd", "angular_msd"})

    def test_collective_states_of_all_robots_have_a_program_without_name(self):
        collective = self.run_.collective
        everybody = collective[collective.program == ""]
        self.assertIn("polar_order", set(everybody.name))
        self.assertEqual(collective.attrs["units"]["t"], "s")
        self.assertGreater(everybody.t.max(), 30)

    def test_trajectories_say_units_and_meanings(self):
        report = self.run_.trajectories
        self.assertEqual(set(report.columns), set(report.attrs["descriptions"]))
        self.assertEqual(report.attrs["units"]["x_stitched"], "cm")

    def test_above_brings_columns_of_the_tables_above(self):
        lags = self.run_.table("ANALYSIS", "curves.lags", columns=["lag", "value"],
                               above=["robot_id", "curves.name", "curves.unit"])
        self.assertEqual(list(lags.columns), ["lag", "value", "robot_id", "name", "unit"])
        self.assertEqual(set(lags[lags.name == "msd"].unit), {"m^2"})
        counts = self.run_.table("ANALYSIS", "curves", columns=["num_lags"]).num_lags
        self.assertEqual(len(lags), counts.sum())

    def test_light_is_that_of_the_sensors(self):
        states = self.run_.states
        still = states[(states.t % 10 > 1) & (states.t > 0)]
        light = self.run_.light.at(still.t, 0.6, 0.45)
        self.assertLess(float(abs(still.light_front - light).mean()), 0.02)
        self.assertEqual(self.run_.light.field(5).at(0.6, 0.45), 0.2)
        self.assertEqual(self.run_.light.field(15).label, "half: ABP")
        self.assertTrue(math.isnan(self.run_.light.at(-1e3, 0.6, 0.45)))
        image = self.run_.light.field(25).image(cell=0.05)
        self.assertEqual(image.shape, (18, 24))
        self.assertEqual(set(image.ravel()), {0.9})

    def test_light_does_not_depend_on_the_order_of_times(self):
        t = numpy.linspace(-1, 39, 200)
        mixed = numpy.random.default_rng(1).permutation(200)
        light = self.run_.light.at(t, 0.5, 0.5)
        numpy.testing.assert_array_equal(self.run_.light.at(t[mixed], 0.5, 0.5), light[mixed])

    def test_experiment_and_summary_are_dicts(self):
        self.assertEqual(self.run_.experiment["name"], "light_switching")
        self.assertEqual(self.run_.summary["experiment"], "light_switching")
        self.assertEqual(self.run_.arena, (1.2, 0.9))
        self.assertTrue(any(picture.name == "light.svg" for picture in self.run_.pictures))

    def test_wrong_names_are_answered_with_those_that_exist(self):
        with self.assertRaisesRegex(KeyError, "it has .*TRACKED_FRAME"):
            self.run_.table("TRACKED")
        with self.assertRaisesRegex(KeyError, "'robots'"):
            self.run_.table("TRACKED_FRAME", "robot")
        with self.assertRaisesRegex(KeyError, "it has .*theta"):
            self.run_.table("TRACKED_FRAME", "robots", columns=["angle"])
        with self.assertRaises(FileNotFoundError):
            active_lab.open(self.folder / "nothing")
        with self.assertRaisesRegex(FileNotFoundError, "log.lcmlog"):
            active_lab.open(self.folder)
        with self.assertRaisesRegex(ValueError, "not an LCM log"):
            active_lab.Log(self.path / "experiment.toml")

    def test_a_log_alone_is_a_run(self):
        copy = self.folder / "alone.lcmlog"
        copy.write_bytes(self.log.read_bytes())
        pandas.testing.assert_frame_equal(active_lab.open(copy).poses, self.run_.poses)

    def test_a_damaged_log_gives_what_is_whole(self):
        data = bytearray(self.log.read_bytes())
        middle = len(data) // 2
        data[middle:middle + 20_000] = bytes(20_000)  # some frames long
        damaged = self.folder / "damaged.lcmlog"
        damaged.write_bytes(data)
        run = active_lab.open(damaged)
        self.assertGreater(run.damaged_places, 0)
        self.assertLess(len(run.poses), len(self.run_.poses))
        self.assertGreater(len(run.poses), 0.99 * len(self.run_.poses))


class DamagedLogs(RunTestCase):
    """Nothing that a log holds keeps it from being read."""

    REPORT = False

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.damaged = {}
        for packed in (ROOT / "tests" / "system" / "damage" / "logs").glob("*.xz"):
            log = cls.folder / packed.stem
            log.write_bytes(lzma.decompress(packed.read_bytes()))
            cls.damaged[packed.name.split(".")[0]] = log

    def read_all(self, log):
        """Everything that a run gives, or an error that names what is missing."""
        run = active_lab.open(log)
        repr(run).encode()
        str(run.channels), str(run.tables)
        for name in ("poses", "truth", "states", "events", "analysis", "curves", "collective", "experiment", "arena"):
            try:
                getattr(run, name)
            except (KeyError, ValueError) as error:
                self.assertNotIsInstance(error, UnicodeError, name)
                self.assertRegex(str(error), "it has|no START|is damaged", name)
        for channel, path in zip(run.tables.channel, run.tables.path):
            if run.type_of(channel) in set(run.channels.type[run.channels.index == channel]):
                run.table(channel, path)
        for _ in run.messages():
            pass
        run.light.at(1.0, 0.5, 0.5)
        if "LIGHT_STATUS" in run:
            repr(run.light.table)
        return run

    def test_shared_damaged_logs_are_read(self):
        self.assertEqual(len(self.damaged), 6)
        for name, log in self.damaged.items():
            with self.subTest(name):
                self.assertGreater(self.read_all(log).message_count, 100)

    def test_what_the_report_refuses_is_in_no_table(self):
        run = active_lab.open(self.damaged["two_bits"])
        raw = run.seconds(run.table("TRACKED_FRAME").utime)
        self.assertGreater(raw.max(), 1e9)
        poses = run.poses
        self.assertLess(poses.t.max(), 1e4)
        self.assertEqual(poses.attrs["refused_messages"], 1)
        self.assertEqual(poses.attrs["removed_robots"], 0)

    def test_a_robot_with_impossible_numbers_is_removed_from_its_frame(self):
        kept = active_lab.open(self.log).poses
        frame = messages.tracked_frame_t(utime=1, frame=7, frame_period=0.02, sender="tracker_svc", robots=[
            messages.tracked_pose_t(robot_id=1, x=math.nan), messages.tracked_pose_t(robot_id=2, x=0.25)])
        longer = self.folder / "longer.lcmlog"
        longer.write_bytes(self.log.read_bytes() + event(10**6, "TRACKED_FRAME", frame.encode()))
        run = active_lab.open(longer)
        self.assertEqual(len(run.poses), len(kept) + 1)
        self.assertEqual((run.poses.x.iloc[-1], run.poses.robot_id.iloc[-1]), (0.25, 2))
        self.assertEqual(run.poses.attrs["removed_robots"], 1)
        self.assertEqual(len(run.table("TRACKED_FRAME", "robots")), len(kept) + 2)

    def test_a_damaged_start_is_named(self):
        data = self.log.read_bytes()
        for wrong in (b'[[[\xff\xfe', b'x = 1 1 1 '):
            place = data.index(b"fileversion")
            damaged = self.folder / "start.lcmlog"
            damaged.write_bytes(data[:place] + wrong + data[place + len(wrong):])
            run = active_lab.open(damaged)
            self.assertIn("with a damaged START", repr(run))
            with self.assertRaisesRegex(ValueError, "START of the experiment is damaged"):
                run.experiment
            self.assertFalse(math.isnan(run.light.at(5, 0.6, 0.45)))
            self.assertIn(wrong.decode("utf-8", "replace"), run.experiment_text)

    def test_a_start_of_a_stranger_takes_little_memory(self):
        def started(text):
            start = messages.experiment_event_t(utime=1, kind=messages.experiment_event_t.START, text=text)
            log = self.folder / "stranger.lcmlog"
            log.write_bytes(event(10**6, "EXPERIMENT_EVENT", start.encode()))
            return active_lab.open(log)

        def deep_in_calls(function, calls):
            return function() if calls == 0 else deep_in_calls(function, calls - 1)

        for text, why in (("x = 1\n" + 20_000 * "a." + "a = 1", "line 2: found a key of more than 32 names"),
                          ("#" + 1_000_000 * "x", "found 1000001 bytes, expected at most 1000000"),
                          ("x = " + 200 * "[" + 200 * "]", "recursion")):
            with self.assertRaisesRegex(ValueError, f"stranger.lcmlog: the START of the experiment is damaged.*{why}"):
                deep_in_calls(lambda: started(text).experiment, 700)
        self.assertEqual(started("x = " + 31 * "a." + "a").experiment_text[:6], "x = a.")
        self.assertEqual(started(31 * "a." + "a = 1").experiment["a"].keys(), {"a"})

    def test_control_characters_are_shown_as_text(self):
        folder = pathlib.Path(os.fsdecode(os.fsencode(self.folder) + b"/odd\x1b[2J\xff"))
        folder.mkdir()
        log = folder / "log.lcmlog"
        data = self.log.read_bytes().replace(b'name = "light_switching"', b'name = "light\\u001B[2J" ')
        log.write_bytes(data + event(10**6, "BAD\x1b]0;x\x07\n\u202e", bytes(8)))
        run = active_lab.open(folder)
        self.assertEqual(run.experiment["name"], "light\x1b[2J")
        for text in (repr(run), repr(active_lab.Log(log))):
            self.assertTrue(all(letter.isprintable() for letter in text.replace("\n", "")), text)
            self.assertRegex(text, r"\n  BAD\\x1b\]0;x\\x07\\x0a\\u202e +1 unknown type(\n|$)")
            self.assertIn("odd\\x1b[2J\ufffd", text)
        self.assertIn(": light\\x1b[2J, seed ", repr(run))

    def test_mutants_of_a_log_are_read(self):
        whole = self.damaged["replay_gap_1"].read_bytes()[:20_000]
        random = numpy.random.default_rng(33)
        mutant = self.folder / "mutant.lcmlog"
        for number in range(100):
            data = bytearray(whole)
            for place in random.integers(28, len(data), random.integers(1, 40)):
                data[place] = random.integers(256)
            if number % 3 == 0:
                begin = int(random.integers(28, len(data)))
                del data[begin:begin + int(random.integers(1, 200))]
            mutant.write_bytes(data)
            with self.subTest(number):
                self.read_all(mutant)

    def test_pipes_are_refused_at_once(self):
        folder = self.folder / "pipes"
        (folder / "images").mkdir(parents=True)
        (folder / "log.lcmlog").write_bytes(self.log.read_bytes())
        for name in ("summary.json", "trajectories.csv", "frames.csv", "images/pipe.png"):
            os.mkfifo(folder / name)
        run = active_lab.open(folder)
        for name in ("summary", "trajectories"):
            with self.assertRaisesRegex(OSError, "no regular file"):
                getattr(run, name)
            (folder / f"{name}.{'json' if name == 'summary' else 'csv'}").unlink()
        (folder / "trajectories.csv").symlink_to("/proc/self/environ")
        with self.assertRaisesRegex(OSError, "no regular file"):
            run.trajectories  # pylint: disable=pointless-statement
        for text in ("{", "[]", "[" * 100_000):
            (folder / "summary.json").write_text(text, encoding="utf-8")
            with self.assertRaisesRegex(ValueError, "summary.json: .*lab analyze"):
                run.summary  # pylint: disable=pointless-statement
        self.assertEqual((run.films, run.pictures), ([], []))
        self.assertEqual(run.light.field(5).at(0.6, 0.45), 0.2)
        os.mkfifo(folder / "pipe.lcmlog")
        with self.assertRaisesRegex(ValueError, "not an LCM log"):
            active_lab.Log(folder / "pipe.lcmlog")

    def test_images_above_the_limit_are_not_read(self):
        folder = self.folder / "large_image"
        (folder / "images").mkdir(parents=True)
        (folder / "log.lcmlog").write_bytes(self.log.read_bytes())
        with open(folder / "images" / "large.png", "wb") as image:
            image.truncate(1 << 30)
        run = active_lab.open(folder)
        before_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        self.assertEqual(run.light.field(5).at(0.6, 0.45), 0.2)
        self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb, 500_000)


def event(utime, channel, encoding):
    """One event of a log, by docs/formats.md."""
    name = channel.encode()
    return struct.pack(">IqqII", 0xEDA1DA01, 0, utime, len(name), len(encoding)) + name + encoding


class OwnMessages(unittest.TestCase):
    def test_wrong_values_are_named(self):
        with self.assertRaisesRegex(TypeError, "no field robots.*num_orders"):
            messages.robot_command_t(robots=[])
        for wrong, text in ((dict(mode=300), "mode: found 300, expected -128 to 127"),
                            (dict(mode="drive"), "mode: found 'drive', expected a whole number"),
                            (dict(wheel_left="fast"), "wheel_left: found 'fast', expected a number"),
                            (dict(robot_ids=[1.5]), "robot_ids: found 1.5, expected a whole number"),
                            (dict(bands=[1]), "bands: found 1, expected a light_band_t")):
            with self.assertRaisesRegex(ValueError, text):
                messages.robot_order_t(**wrong).encode()
        with self.assertRaisesRegex(ValueError, "values: found 2 elements, expected 8"):
            messages.sense_values_t(values=[1, 2]).encode()
        with self.assertRaisesRegex(ValueError, "sigma: found 0 elements, expected 1 as in lag"):
            messages.curve_t(lag=[1], value=[1]).encode()

    def test_counts_follow_from_the_lists(self):
        stop = messages.decode(messages.robot_stop_t(robot_ids=numpy.array([3, 4])).encode())
        self.assertEqual((stop.num_robots, stop.robot_ids), (2, [3, 4]))

    def test_decoding_refuses_damaged_bytes(self):
        encoding = messages.robot_stop_t(robot_ids=[3, 4], reason="why").encode()
        for wrong in (encoding[:-1], encoding + b"\0", encoding[:30]):
            with self.assertRaises(ValueError):
                messages.decode(wrong)
        with self.assertRaisesRegex(ValueError, "fingerprint"):
            messages.decode(b"12345678")
        with self.assertRaisesRegex(ValueError, "found a robot_stop_t, expected a clock_t"):
            messages.clock_t.decode(encoding)

    def test_help_has_fields_units_and_constants(self):
        self.assertIn("wheel_left: double [m/s]", messages.robot_order_t.__doc__)
        self.assertIn("DRIVE = 2", messages.robot_order_t.__doc__)
        self.assertEqual(messages.robot_order_t.DRIVE, 2)


if __name__ == "__main__":
    main()
