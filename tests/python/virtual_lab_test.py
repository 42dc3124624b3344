"""Programs of the user in virtual time: `lab run FILE --virtual-time --with script.py`."""
import math
import shutil
import signal
import subprocess
import tempfile
import textwrap
import unittest
from pathlib import Path

import numpy

import active_lab
from support import BIN, experiment, lab, main


class VirtualLab(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="lab_python_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)

    def run_with(self, program, name="abp", seconds=8, arguments="", expect=0, options=(), file="script.py"):
        """Runs an experiment with a program; gives the run and what was printed."""
        folder = self.folder / self.id()
        folder.mkdir(exist_ok=True)
        script = folder / file
        script.write_text("import active_lab\n" + textwrap.dedent(program))
        known = set(folder.glob("runs/*"))
        output = lab("run", experiment(name), "--virtual-time", "--no-report", "--runs", folder / "runs", "--set",
                     f"duration_s={seconds}", "--with", f"{script} {arguments}".strip(), *options, expect=expect)
        (made,) = set(folder.glob("runs/*")) - known
        return active_lab.open(made), output

    ALONG_X = """
        with active_lab.Lab() as lab:
            for frame in lab.frames():
                for robot in frame.robots:
                    lab.drive(robot.robot_id, forward=0.03, turn=-3 * robot.theta)
        """

    def test_a_closed_loop_turns_robots_along_x(self):
        run, _ = self.run_with(self.ALONG_X, seconds=6)
        truth = run.truth
        late = truth[(truth.t > 3) & (truth.x < 1.1)]
        self.assertGreater(len(late), 10)
        self.assertLess(float(abs(late.theta.map(lambda angle: math.remainder(angle, math.tau))).max()), 0.1)
        self.assertEqual(run.damaged_places, 0)

    def test_drive_keeps_to_the_limit_of_the_wheels(self):
        run, output = self.run_with("""
            with active_lab.Lab() as lab:
                for wrong in ("a", 1.5, -1, None, 2**31):
                    try:
                        lab.drive(wrong)
                    except ValueError as error:
                        print(error)
                lab.sleep(2)
                lab.drive(1, left=9, right=4.5)
                lab.sleep(1)
                state = lab.states[1]
                limit = lab.experiment["robot"]["max_wheel_speed_cm_s"] / 100
                print("wheels", abs(state.wheel_left - limit) < 0.01, abs(state.wheel_right - limit / 2) < 0.01)
                print("limited", lab.limited)
            """, seconds=4)
        self.assertEqual(output.count("expected the id of a robot"), 5, output)
        self.assertIn("wheels True True", output)
        self.assertIn("limited 1", output)

    def test_the_same_program_gives_the_same_log(self):
        first, _ = self.run_with(self.ALONG_X, seconds=4)
        second, _ = self.run_with(self.ALONG_X, seconds=4)
        self.assertEqual(first.path.read_bytes(), second.path.read_bytes())

    def test_computing_takes_no_virtual_time(self):
        slow = self.ALONG_X.replace("for robot in", "import time; time.sleep(0.003)\n                for robot in")
        first, _ = self.run_with(self.ALONG_X, seconds=2)
        second, _ = self.run_with(slow, seconds=2)
        digest = "user program"
        self.assertTrue((first.poses == second.poses).all().all())
        self.assertIn(digest, " ".join(first.events.text))

    def test_time_is_that_of_the_lab(self):
        _, output = self.run_with("""
            with active_lab.Lab() as lab:
                begin = lab.utime
                lab.sleep(1.5)
                print("slept", lab.utime - begin)
                ticks = []
                lab.every(0.25, lambda: ticks.append(lab.utime - begin))
                lab.sleep(1)
                print("ticks", ticks)
                count = sum(1 for _ in lab.frames(seconds=2))
                print("frames", count)
                lab.run()
                print("ended", lab.ended, round(lab.t, 3))
            """, seconds=6)
        self.assertIn("slept 1500000", output)
        self.assertIn("ticks [1750000, 2000000, 2250000, 2500000]", output)
        self.assertIn("frames 100", output)  # 50 frames per second
        self.assertRegex(output, r"ended True 6\.\d")

    def test_light_is_shown_and_returns_to_the_script(self):
        run, output = self.run_with("""
            with active_lab.Lab() as lab:
                lab.sleep(1)
                lab.light({"kind": "disk", "x_cm": 60, "y_cm": 45, "radius_cm": 20, "intensity": 1},
                          label="spot", wait=1)
                print("shown", lab.t)
                lab.sleep(2)
                lab.light([0.25, {"kind": "disk", "x_cm": 20, "y_cm": 20, "radius_cm": 5, "intensity": 0.75}])
                lab.sleep(1)
                lab.release_light()
                lab.run()
            """, name="light_switching", seconds=8)
        numpy.testing.assert_array_equal(run.light.at([2, 2, 3.9, 3.9], [0.6, 0.9, 0.2, 0.5], [0.45, 0.45, 0.2, 0.5]),
                                         [1, 0, 0.75, 0.25])
        self.assertEqual(run.light.field(2).label, "spot")
        self.assertEqual(run.light.field(6).label, "dim: BP")

    def test_a_light_goes_with_its_program(self):
        run, _ = self.run_with("""
            lab = active_lab.Lab()
            lab.light(0.75)
            lab.sleep(1)
            """, name="light_switching", seconds=8)
        self.assertEqual(run.light.field(0.9).at(0.5, 0.5), 0.75)
        self.assertEqual(run.light.field(7).label, "dim: BP")
        self.assertIn("the user program has ended", set(run.events.text))

    def test_wrong_layers_are_named_as_in_experiment_files(self):
        _, output = self.run_with("""
            with active_lab.Lab() as lab:
                for wrong in ({"kind": "disc", "intensity": 1}, {"kind": "uniform", "intensity": 2}):
                    try:
                        lab.light(wrong)
                    except ValueError as error:
                        print("refused:", error)
            """, seconds=1)
        self.assertRegex(output, r"refused: .*kind.*disc")
        self.assertRegex(output, r"refused: .*intensity")

    def test_what_the_projector_refuses_is_raised(self):
        _, output = self.run_with("""
            from active_lab import messages
            with active_lab.Lab() as lab:
                layers = [messages.light_layer_t(kind=messages.light_layer_t.DISK, size=-1.0)]
                lab._set_light(messages.light_command_t(priority=10, from_utime=lab.utime, layers=layers))
                try:
                    lab.sleep(1)
                except active_lab.Refused as error:
                    print("refused:", error)
            """, name="light_switching", seconds=2)
        self.assertRegex(output, r"refused: light: .*size")

    def test_orders_of_one_frame_travel_in_one_message(self):
        run, _ = self.run_with(self.ALONG_X, seconds=3)
        commands = run.table("ROBOT_COMMAND", columns=["sender", "seq", "num_orders"])
        ours = commands[commands.sender == "script"]
        robots = run.poses.robot_id.nunique()
        self.assertEqual(set(ours.num_orders), {robots})
        self.assertLessEqual(len(ours), 50 * 4)

    def test_a_robot_stands_runs_a_program_and_returns(self):
        run, _ = self.run_with("""
            with active_lab.Lab() as lab:
                lab.sleep(1)
                lab.stand(1)
                lab.sleep(1)
                lab.program(1, "rtp")
                lab.sleep(2)
                lab.release()
                lab.run()
            """, name="light_switching", seconds=8)
        robot = run.states[run.states.robot_id == 1]
        program = {t: robot[robot.t <= t].program_name.iloc[-1] for t in (0.9, 1.9, 3.9, 7)}
        self.assertEqual(program, {0.9: "bp", 1.9: "", 3.9: "rtp", 7: "bp"})
        standing = robot[(robot.t > 1.2) & (robot.t < 1.9)]
        self.assertEqual(float(standing.wheel_left.abs().max()), 0)

    def test_stop_stops_every_robot_until_it_is_released(self):
        run, output = self.run_with("""
            with active_lab.Lab() as lab:
                lab.sleep(1)
                lab.stop("enough")
                print("stopped", sorted(lab.states))
                lab.sleep(1)
                lab.release_stop()
                lab.run()
            """, seconds=4)
        self.assertIn("stopped [1", output)
        states = run.states
        still = states[(states.t > 1.3) & (states.t < 2)]
        self.assertEqual(float(still.wheel_left.abs().max()), 0)
        self.assertGreater(float(states[states.t > 2.5].wheel_left.abs().max()), 0)

    def test_marks_and_end_are_recorded(self):
        run, _ = self.run_with("""
            with active_lab.Lab() as lab:
                lab.sleep(1)
                lab.mark("robot 1 looks odd")
                lab.pause()
                lab.sleep(1)
                lab.resume()
                lab.end("seen enough")
            """, seconds=60)
        marks = list(run.events[run.events.kind == "MARK"].text)
        self.assertTrue(any("robot 1 looks odd" in mark for mark in marks))
        end = run.events[run.events.kind == "END"].iloc[0]
        self.assertIn("seen enough", end.text)
        self.assertLess(end.t, 10)

    def test_handlers_get_messages_of_any_channel(self):
        _, output = self.run_with("""
            from collections import Counter
            with active_lab.Lab() as lab:
                seen = Counter()
                for channel in ("CLOCK", "SIM_TRUTH", "SERVICE_STATUS"):
                    lab.subscribe(channel, lambda message, channel=channel: seen.update([channel]))
                lab.run(seconds=3)
                print("seen", seen["CLOCK"], seen["SIM_TRUTH"] > 10, seen["SERVICE_STATUS"] > 5)
                print("programs", sorted({state.program.name for state in lab.states.values()}))
                print(lab.experiment["name"])
            """, seconds=4)
        self.assertRegex(output, r"seen [234] True True")
        self.assertIn("programs ['abp']", output)

    def test_a_program_that_fails_ends_the_run(self):
        run, output = self.run_with("""
            with active_lab.Lab() as lab:
                lab.sleep(1)
                raise RuntimeError("my mistake")
            """, seconds=60, expect=3)
        self.assertIn("RuntimeError: my mistake", output)
        self.assertIn("fault", output)
        faults = list(run.events[run.events.kind == "FAULT"].text)
        self.assertEqual(len(faults), 1)
        self.assertIn("script.py ended with exit code 1", faults[0])
        self.assertLess(run.poses.t.max(), 5)

    def test_a_program_may_end_and_get_arguments(self):
        run, output = self.run_with("""
            import sys
            print("arguments", sys.argv[1:])
            """, seconds=3, arguments="--gain 3")
        self.assertIn("arguments ['--gain', '3']", output)
        self.assertGreater(run.poses.t.max(), 2.9)
        self.assertTrue((run.folder / "user_program" / "script.py").exists())
        self.assertIn("--gain 3", run.events[run.events.kind == "MARK"].text.iloc[0])

    def test_a_program_whose_file_has_a_long_name_is_heard(self):
        name = 20 * "long" + ".py"
        run, _ = self.run_with("""
            with active_lab.Lab() as lab:
                lab.mark("heard")
            """, seconds=2, file=name)
        self.assertIn("heard", " ".join(run.events.text))
        self.assertIn(name[:63], set(run.table("SERVICE_STATUS").sender))

    def interrupted_at(self, text, program):
        """Runs a program that takes too long until the lab prints a line with `text`, then presses Ctrl-C."""
        script = self.folder / f"{self.id()}.py"
        script.write_text("import time\n" + textwrap.dedent(program))
        process = subprocess.Popen([BIN / "lab", "run", experiment("abp"), "--virtual-time", "--no-report", "--runs",
                                    self.folder / self.id(), "--set", "duration_s=2", "--with", script],
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.kill)
        lines = []
        for line in process.stdout:
            lines.append(line)
            if text in line:
                break
        else:
            self.fail("".join(lines))
        process.send_signal(signal.SIGINT)
        lines.append(process.communicate(timeout=120)[0])
        # On a loaded machine, Python may take so long to start that this is said, too.
        waits = [line for line in "".join(lines).splitlines() if line.startswith("waiting ")]
        self.assertEqual(len(waits), len(set(waits)), lines)
        self.assertEqual(sum(text in line for line in waits), 1, lines)

    def test_a_long_wait_for_the_program_is_said(self):
        self.interrupted_at("the run begins when it calls active_lab.Lab()", "time.sleep(600)")
        self.interrupted_at("virtual time stands still", """
            import active_lab
            with active_lab.Lab() as lab:
                lab.sleep(1)
                time.sleep(600)
            """)
        self.interrupted_at("waiting for the end of", """
            import active_lab
            with active_lab.Lab() as lab:
                lab.run()
            time.sleep(600)
            """)

    def test_messages_of_the_program_are_counted(self):
        run, _ = self.run_with(self.ALONG_X, seconds=3)
        heartbeats = run.table("SERVICE_STATUS", "sent", above=["sender", "state"])
        final = heartbeats[(heartbeats.sender == "script") & (heartbeats.state == 4)]
        counted = final[final.channel == "ROBOT_COMMAND"].messages.max()
        commands = run.table("ROBOT_COMMAND", columns=["sender"])
        self.assertEqual(counted, (commands.sender == "script").sum())

    def test_wrong_programs_are_refused_before_the_run(self):
        output = lab("run", experiment("abp"), "--virtual-time", "--with", "nothing.py", expect=2)
        self.assertIn("--with nothing.py: there is no such file", output)
        plain = self.folder / "plain.txt"
        plain.write_text("no program")
        output = lab("run", experiment("abp"), "--virtual-time", "--with", plain, expect=2)
        self.assertIn("neither Python (.py) nor executable", output)


class PythonCommand(unittest.TestCase):
    """`lab python` in a folder of a stranger."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="lab_python_"))
        self.addCleanup(shutil.rmtree, self.folder)
        for module in ("numpy", "json"):
            (self.folder / f"{module}.py").write_text("raise SystemExit('a module of the current folder')\n")

    def test_modules_of_the_current_folder_are_not_imported(self):
        for arguments in (["-c", "import active_lab, json"], ["-Bcimport active_lab"],
                          ["-Wignore", "-m", "json.tool", "-h"],
                          ["-X", "utf8", "-W", "ignore", "-c", "import numpy"], [], ["-i"], ["-"]):
            with self.subTest(arguments):
                done = subprocess.run([BIN / "lab", "python", *arguments], cwd=self.folder,
                                      input="import numpy, json\n", capture_output=True, text=True, timeout=600)
                self.assertEqual((done.returncode, "current folder" in done.stderr), (0, False), done.stderr)

    def test_a_script_imports_modules_of_its_own_folder(self):
        (self.folder / "helper.py").write_text("answer = 42\n")
        (self.folder / "numpy.py").unlink()
        (self.folder / "json.py").unlink()
        script = self.folder / "script.py"
        script.write_text("import active_lab, helper\nprint(helper.answer)\n")
        for options in ([], ["-B"], ["-W", "ignore"], ["--check-hash-based-pycs", "default"]):
            self.assertEqual(lab("python", *options, script), "42\n")


if __name__ == "__main__":
    main()
