#!/usr/bin/env python3
"""CPU time and memory of `lab analyze` of a CSV file of poses with a program, beside pandas.read_csv and a mean
square displacement by Fourier transforms of the same file in the same run.

  /usr/bin/python3 tests/benchmarks/pose_file_benchmark.py PATH_OF_LAB [ROBOTS] [HOURS]

The robots are active Brownian (v = 5 cm/s, epsilon = 0.5 s, eta = 3 rad/s), filmed at 100 frames/s with a noise of
0.1 mm. The file takes 45 MB for each robot and hour and is removed.
"""
import os
import subprocess
import sys
import tempfile

import numpy as np
import pandas as pd

FPS = 100
PROGRAM = ["--scale-cm", "1", "--program", "abp", "--set", "v_cm_s=5", "--set", "epsilon_s=0.5",
           "--set", "eta_rad_s=3"]
PANDAS = """
import sys
import numpy as np
import pandas as pd
table = pd.read_csv(sys.argv[1])
for _, track in table.groupby("id"):
    n = len(track)
    msd = np.zeros(n)
    for name in ("x", "y"):
        place = track[name].to_numpy()
        spectrum = np.fft.rfft(place, 2 * n)
        products = np.fft.irfft(np.abs(spectrum) ** 2, 2 * n)[:n]
        square = place * place
        sums = np.cumsum(square)
        ends = sums[::-1] + sums[-1] - np.concatenate(([0], sums[:-1]))
        msd += (ends - 2 * products) / (n - np.arange(n))
"""


def write_poses(file, robots, hours):
    """Rows in order of frames, a minute at a time."""
    random = np.random.default_rng(1)
    hold = FPS // 2
    place = np.column_stack((3.0 * np.arange(robots), np.zeros(robots)))
    heading = random.uniform(-np.pi, np.pi, robots)
    minute = 60 * FPS
    with open(file, "w", encoding="ascii") as out:
        for number in range(int(hours * 60)):
            omega = np.repeat(random.uniform(-3, 3, (minute // hold, robots)), hold, axis=0)
            turned = heading + np.cumsum(omega, axis=0) / FPS
            before = turned - omega / (2 * FPS)
            steps = 5 / FPS * np.stack((np.cos(before), np.sin(before)), axis=2)
            path = place + np.cumsum(steps, axis=0)
            place, heading = path[-1], turned[-1]
            seen = path + random.normal(0, 0.01, path.shape) + np.stack(
                (40.0 * np.arange(robots), np.zeros(robots)), axis=1)
            frame = np.repeat(np.arange(number * minute, (number + 1) * minute), robots)
            pd.DataFrame({
                "frame": frame, "id": np.tile(np.arange(1, robots + 1), minute),
                "x": seen[:, :, 0].ravel().round(4), "y": seen[:, :, 1].ravel().round(4),
                "theta": (np.remainder(turned.ravel() + np.pi, 2 * np.pi) - np.pi).round(5),
                "t_s": (frame / FPS).round(3)}).to_csv(out, index=False, header=number == 0)


def measure(command):
    """CPU time [s] and largest memory [MB] of a process with its children."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{command[0]} failed")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1000


def main():
    lab = sys.argv[1]
    robots = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    hours = float(sys.argv[3]) if len(sys.argv) > 3 else 1.0
    with tempfile.TemporaryDirectory(dir="/var/tmp") as folder:
        file = os.path.join(folder, "poses.csv")
        write_poses(file, robots, hours)
        ours = measure([lab, "analyze", file, *PROGRAM, "--no-figures", "--out",
                        os.path.join(folder, "report")])
        theirs = measure([sys.executable, "-c", PANDAS, file])
    print(f"{robots} robots, {hours:g} h at {FPS} frames/s: lab analyze {ours[0]:.2f} s of CPU, {ours[1]:.0f} MB; "
          f"pandas and Fourier transforms {theirs[0]:.2f} s, {theirs[1]:.0f} MB; ratio {ours[0] / theirs[0]:.2f}")


main()
