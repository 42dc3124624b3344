#!/usr/bin/env python3
"""CPU time of every process of live labs, as the cost of a robot, a frame, and a robot in a frame.

  tests/in_private_network.sh tests/benchmarks/robots_per_core.py FOLDER_OF_PROGRAMS RESULT.csv [SECONDS]

Each process costs  fixed + robots * a + frames/s * b + robots * frames/s * c  cores. The least squares
of several labs with different numbers of robots and frames give the four costs, each lab measured in
WINDOWS parts, whose scatter gives the standard errors. CPU time is what the scheduler counted for all
threads (/proc/PID/task/*/schedstat, ns): other work on the machine does not count, but it slows caches and
cores, so the load is printed, too. The table of common/experiment/experiment_load.cpp, which `lab check`
uses, comes from here.
"""

import os
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
WARM_UP_S = 6
WINDOWS = 3

# Robots, frames/s. The tracker is the simulated one, or tracker_svc on painted pictures of 1280 x 720.
SIMULATED = [(10, 25), (100, 25), (10, 100), (100, 100)]
PAINTED = [(2, 30), (20, 30), (40, 30), (20, 10)]
ROS = [(5, 25), (50, 25), (5, 50), (50, 50)]


def cpu_seconds(process):
    """Of all threads that run; services end none of theirs while they work."""
    return sum(int((task / "schedstat").read_text().split()[0]) * 1e-9
               for task in (process / "task").iterdir())


def processes(parent):
    """@return {name: CPU seconds} of the process and of its children"""
    times = {}
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            name, rest = (entry / "stat").read_text().split("(", 1)[1].rsplit(")", 1)
            if int(entry.name) == parent or int(rest.split()[1]) == parent:
                times[name] = cpu_seconds(entry)
        except OSError:
            continue
    return times


def frames_per_second(log):
    """From the log: the rate of TRACKED_FRAME."""
    data, at, times = log.read_bytes(), 0, []
    while at + 28 <= len(data):
        _, _, utime, channel, size = struct.unpack_from(">IqqII", data, at)
        if data[at + 28:at + 28 + channel] == b"TRACKED_FRAME":
            times.append(utime * 1e-6)
        at += 28 + channel + size
    return (len(times) - 1) / (times[-1] - times[0])


def measure(programs, experiment, robots, fps, seconds, *settings):
    """@return (frames/s, [{process: cores}] of every window)"""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        command = [programs / "lab", "run", ROOT / "experiments" / experiment, "--no-report",
                   "--no-web", "--runs", folder / "runs", "--set", f"robots[0].count={robots}",
                   "--set", f"camera.fps={fps}", "--set", "robot.status_rate_hz=20"]
        for setting in settings:
            command += ["--set", setting]
        with open(folder / "output", "w", encoding="utf-8") as output:
            lab = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT,
                                   env=dict(os.environ, XDG_RUNTIME_DIR=name))
        try:
            time.sleep(WARM_UP_S)
            windows = []
            before, began = processes(lab.pid), time.monotonic()
            for _ in range(WINDOWS):
                time.sleep(seconds / WINDOWS)
                after, ended = processes(lab.pid), time.monotonic()
                windows.append({name: (after[name] - before[name]) / (ended - began)
                                for name in after if name in before})
                before, began = after, ended
        finally:
            lab.send_signal(signal.SIGINT)
            lab.wait(60)
        if "sim_svc" not in after:
            raise SystemExit((folder / "output").read_text(encoding="utf-8"))
        log = next((folder / "runs").glob("*/log.lcmlog"))
        return frames_per_second(log), windows


def invert(matrix):
    """By Gauss and Jordan; the matrices here are small and positive."""
    size = len(matrix)
    rows = [row + [float(i == j) for j in range(size)] for i, row in enumerate(matrix)]
    for i in range(size):
        pivot = rows[i][i]
        rows[i] = [x / pivot for x in rows[i]]
        for j in range(size):
            if j != i:
                factor = rows[j][i]
                rows[j] = [x - factor * y for x, y in zip(rows[j], rows[i])]
    return [row[size:] for row in rows]


def solve(rows):
    """Least squares of [(factors, value)] by the normal equations; costs are not negative.
    @return [(cost, standard error)]; a cost that would be negative is (0, 0)"""
    size = len(rows[0][0])
    free = list(range(size))
    while True:
        inverse = invert([[sum(f[i] * f[j] for f, _ in rows) for j in free] for i in free])
        right = [sum(f[i] * v for f, v in rows) for i in free]
        found = {i: sum(x * y for x, y in zip(line, right)) for i, line in zip(free, inverse)}
        negative = [i for i in free if found[i] < 0]
        if not negative:
            break
        free.remove(min(negative, key=lambda i: found[i]))
    squares = sum((v - sum(found[i] * f[i] for i in free)) ** 2 for f, v in rows)
    variance = squares / max(1, len(rows) - len(free))
    errors = {i: (variance * inverse[k][k]) ** 0.5 for k, i in enumerate(free)}
    return [(found.get(i, 0.0), errors.get(i, 0.0)) for i in range(size)]


def main():
    programs, result = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 15
    small = ["robot.diameter_cm=4", "reversal.distance_cm=6"]  # room for 100
    families = [("simulated tracker", "swarm.toml", SIMULATED, small),
                ("painted camera", "optical_loop.toml", PAINTED, ["duration_s=600"]),
                ("ROS 2", "swarm.toml", ROS, [*small, "gateway.ros=true"])]
    lines = ["lab,process,fixed (% of a core),error,per robot (% of a core),error,per frame (us),error,"
             "per robot and frame (us),error"]
    for family, experiment, cases, settings in families:
        rows = {}
        for robots, fps in cases:
            frames, windows = measure(programs, experiment, robots, fps, seconds, *settings)
            print(f"{family}: {robots} robots, {frames:.1f} of {fps} frames/s, load "
                  f"{os.getloadavg()[0]:.1f}: "
                  + ", ".join(f"{name} {100 * sum(w[name] for w in windows) / WINDOWS:.1f} %"
                              for name in sorted(windows[0])), flush=True)
            if frames < 0.5 * fps:
                raise SystemExit("the machine is too slow for these frames: nothing was measured")
            for uses in windows:
                for name, use in uses.items():
                    rows.setdefault(name, []).append(([1, robots, frames, frames * robots], use))
        for name, measured in sorted(rows.items()):
            fixed, robot, frame, both = solve(measured)
            lines.append(f"{family},{name},{100 * fixed[0]:.2f},{100 * fixed[1]:.2f},"
                         f"{100 * robot[0]:.4f},{100 * robot[1]:.4f},"
                         f"{1e6 * frame[0]:.0f},{1e6 * frame[1]:.0f},"
                         f"{1e6 * both[0]:.2f},{1e6 * both[1]:.2f}")
    result.parent.mkdir(parents=True, exist_ok=True)
    result.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
