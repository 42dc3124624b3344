"""A live lab in a program: found by its registration, or started with the run. In a private network."""
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import textwrap
import time
import unittest
from pathlib import Path
from unittest import mock

import active_lab
from active_lab import messages
from support import BIN, experiment, lab, main


class LiveLab(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="lab_python_"))
        self.addCleanup(shutil.rmtree, self.folder)
        os.environ["XDG_RUNTIME_DIR"] = str(self.folder)  # registrations of this test alone

    def start(self, name, seconds, *options):
        process = subprocess.Popen([BIN / "lab", "run", experiment(name), "--no-report", "--no-web", "--runs",
                                    self.folder / "runs", "--set", f"duration_s={seconds}", *options],
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.kill)
        return process

    def finished(self, process):
        output = process.communicate(timeout=120)[0]
        self.assertEqual(process.returncode, 0, output)
        (made,) = (self.folder / "runs").glob("*")
        return active_lab.open(made), output

    def test_a_bus_that_is_a_file_is_refused(self):
        thesis = self.folder / "thesis.tex"
        thesis.write_text("kept", encoding="utf-8")
        url = f"file://{thesis}?mode=w"
        registry = self.folder / "active-lab"
        registry.mkdir(mode=0o700)
        (registry / "a.json").write_text(json.dumps({"name": "a", "url": url, "pid": os.getpid(), "directory": "",
                                                     "replay": False}), encoding="utf-8")
        for named in ({}, {"name": "a"}, {"url": url}):
            with self.assertRaisesRegex(OSError, 'found the provider "file", expected udpm://'):
                active_lab.Lab(**named)
        self.assertEqual(thesis.read_text(encoding="utf-8"), "kept")

    def test_the_name_of_a_lab_is_shown_without_control_characters(self):
        with active_lab.Lab(name="a\x1b[2J", url="udpm://239.255.76.67:7667?ttl=0") as lab_:
            self.assertEqual(repr(lab_), "<Lab a\\x1b[2J, live>")

    def test_a_program_beside_the_lab_sets_light_drives_and_ends(self):
        process = self.start("light_switching", 60)
        deadline = time.monotonic() + 60
        while not active_lab.running_labs() and time.monotonic() < deadline:
            time.sleep(0.1)
        with active_lab.Lab(sender="my_program") as lab_:
            self.assertEqual(lab_.experiment["name"], "light_switching")
            self.assertTrue(lab_.wait_for(lambda now: now.poses and now.states, 30))
            lab_.light(0.75, wait=5)
            for frame in lab_.frames(seconds=2):
                lab_.drive(1, forward=0.02)
            self.assertAlmostEqual(lab_.states[1].wheel_left, 0.02, delta=0.005)
            lab_.mark("by my program")
            lab_.end("seen enough")
            for _ in lab_.frames(seconds=10):
                pass
            self.assertTrue(lab_.ended)
        run, output = self.finished(process)
        self.assertIn("seen enough", output)
        self.assertTrue(any("by my program" in text for text in run.events.text))
        shown = run.light.table
        self.assertIn("my_program", set(shown.commander))

    def test_lab_run_starts_a_program_with_a_live_run(self):
        script = self.folder / "follow.py"
        script.write_text(textwrap.dedent("""
            import active_lab
            with active_lab.Lab() as lab:
                for count, frame in enumerate(lab.frames()):
                    if count == 100:
                        lab.end("seen enough")
                print("frames seen", count >= 100, "virtual", lab.virtual, flush=True)
            """))
        run, output = self.finished(self.start("abp", 300, "--with", script))
        self.assertIn("frames seen True virtual False", output)
        self.assertTrue(any("user program follow.py" in text for text in run.events.text))

    def test_a_program_that_fails_ends_a_live_run(self):
        script = self.folder / "wrong.py"
        script.write_text("raise SystemExit('nothing works')\n")
        process = self.start("abp", 60, "--with", script)
        output = process.communicate(timeout=120)[0]
        self.assertEqual(process.returncode, 3, output)
        self.assertIn("nothing works", output)
        self.assertIn("wrong.py ended with exit code 1", output)

    def test_what_services_refuse_does_not_reach_a_program(self):
        script = self.folder / "follow.py"
        script.write_text(textwrap.dedent("""
            import math
            import active_lab
            with active_lab.Lab() as lab:
                print("begun", flush=True)
                wanted = {"EXPERIMENT_STATUS": 4, "TRACKED_FRAME": 2, "ROBOT_STATUS": 1}
                for frame in lab.frames(every=True):
                    assert all(math.isfinite(robot.x) for robot in frame.robots)
                    assert all(math.isfinite(robot.x) for robot in lab.poses.values())
                    assert lab.states is not None and (lab.status is None or lab.status.sender == "lab")
                    if lab.refused == wanted:
                        break
                lab.sleep(1.5)
                print("refused", lab.refused == wanted, "ended", lab.ended, flush=True)
                lab.end("seen enough")
            """))
        process = self.start("abp", 300, "--with", script)
        for line in process.stdout:
            if "begun" in line:
                break
        (url,) = [running.url for running in active_lab.running_labs()]
        bus = active_lab._core.LiveBus(url)
        now = bus.now
        status = messages.experiment_status_t(utime=now, sender="lab", seq=1).encode()
        frame = messages.tracked_frame_t(utime=now, sender="other", seq=1, frame_period=0.02,
                                         robots=[messages.tracked_pose_t(robot_id=1, x=math.nan)]).encode()
        for _ in range(3):
            bus.publish("EXPERIMENT_STATUS", status[:-5])
        bus.publish("EXPERIMENT_STATUS", messages.experiment_status_t(
            utime=now, sender="other", seq=1, phase=messages.experiment_status_t.ENDED).encode())
        bus.publish("TRACKED_FRAME", frame)
        bus.publish("TRACKED_FRAME", status)
        bus.publish("ROBOT_STATUS", b"damaged")
        run, output = self.finished(process)
        self.assertIn("refused True ended False", output)
        beats = [message for _, _, message in run.messages("SERVICE_STATUS") if message.sender == "follow"]
        self.assertEqual({count.channel: count.decode_errors for count in beats[-1].received},
                         {"EXPERIMENT_STATUS": 4, "TRACKED_FRAME": 2, "ROBOT_STATUS": 1})
        self.assertIn("EXPERIMENT_STATUS refused: the bytes are no experiment_status_t", beats[-1].last_error)

    def test_without_a_lab_the_error_says_what_to_do(self):
        with self.assertRaisesRegex(ConnectionError, "lab run FILE --with"):
            active_lab.Lab()

    def test_ctrl_c_ends_run_and_program(self):
        script = self.folder / "endless.py"
        script.write_text("import active_lab\nlab = active_lab.Lab()\nprint('begun', flush=True)\n"
                          "while True:\n    pass\n")
        process = self.start("abp", 60, "--with", script)
        for line in process.stdout:
            if "begun" in line:
                break
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertIn(process.returncode, (0, 3))


class BusOfItsOwn(unittest.TestCase):
    """A program that is alone on a bus, without a network."""

    def connected(self, **options):
        client = active_lab.Lab(url="memq://", **options)
        self.addCleanup(client.close)
        return client

    def test_the_name_of_a_sender_has_at_most_63_bytes(self):
        longest = 61 * "x" + "\u00b0"
        self.assertEqual(self.connected(sender=longest).sender, longest)
        for wrong, size in (("", 0), (longest + "x", 64), ("a\0b", 3)):
            with self.assertRaisesRegex(ValueError, f"sender: found a name of {size} bytes, expected 1 to 63"):
                active_lab.Lab(url="memq://", sender=wrong)
        for file, name in (("/tmp/" + longest + "x.py", longest), (62 * "x" + "\u00b0.py", 62 * "x"), ("", "script"),
                           (os.fsdecode(b"\xff.py"), "\udcff")):
            with mock.patch.object(sys, "argv", [file]):
                self.assertEqual(self.connected().sender, name)

    def test_messages_are_refused_as_services_refuse_them(self):
        client = self.connected(sender="me")
        heard = []
        for channel in ("EXPERIMENT_COMMAND", "ROBOT_STOP"):
            client.subscribe(channel, heard.append)

        def send(channel, message, **fields):
            client._bus.publish(channel, message(utime=client.utime, seq=1, **fields).encode())

        largest = 255_000 * "x"
        command, stop = messages.experiment_command_t, messages.robot_stop_t
        send("EXPERIMENT_COMMAND", command, sender="other", text=largest)
        send("EXPERIMENT_COMMAND", command, sender="other", text=2 * largest)
        send("EXPERIMENT_COMMAND", command, sender=64 * "x")
        send("ROBOT_STOP", stop, sender=64 * "x", reason=2 * largest)
        self.assertTrue(client.wait_for(lambda _: len(heard) + sum(client.refused.values()) >= 4, 60))
        self.assertEqual(client.refused, {"EXPERIMENT_COMMAND": 2})
        self.assertEqual([type(message) for message in heard], [command, stop])
        self.assertRegex(client._first_refused,
                         "EXPERIMENT_COMMAND refused: size: found 510.* bytes, expected at most 256000")


if __name__ == "__main__":
    main()
