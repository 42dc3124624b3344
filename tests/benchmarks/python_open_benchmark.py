#!/usr/bin/env python3
"""CPU time and memory of active_lab.open() and run.poses: an hour of 100 robots at 50 frames/s, with their
reports at 20 Hz.

  PYTHONPATH=build/dev/python /usr/bin/python3 tests/benchmarks/python_open_benchmark.py [HOURS] [ROBOTS]

The log (3 GB an hour) is written to the folder for temporary files (TMPDIR) and removed. Positions differ from
robot to robot and the times from message to message; other numbers repeat, which the reader cannot make use of.
"""
import os
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

START_US = 1_700_000_000_000_000
MEASURE = """
import resource, sys, time
import active_lab
begin = time.process_time()
run = active_lab.open(sys.argv[1])
opened = time.process_time()
poses = run.poses
done = time.process_time()
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
print(f"open {opened - begin:.2f} s, poses {done - opened:.2f} s of CPU, {len(poses)} poses, peak {peak:.0f} MB")
"""


def messages(robots):
    """{channel: (period [us], an encoded message)}; utime is its first field behind the fingerprint."""
    from active_lab import messages as msg

    frame = msg.tracked_frame_t(sender="tracker_svc", seq=1, frame_period=0.02, robots=[
        msg.tracked_pose_t(robot_id=1 + i, x=0.01 * i, y=0.005 * i, theta=0.1 * i, confidence=1.0)
        for i in range(robots)])
    status = msg.robot_status_t(sender="robot_bridge", seq=1, robots=[
        msg.robot_state_t(robot_id=1 + i, utime=START_US) for i in range(robots)])
    return {"TRACKED_FRAME": (20_000, frame.encode()), "ROBOT_STATUS": (50_000, status.encode())}


def write_log(file, hours, robots):
    kinds = messages(robots)
    with open(file, "wb") as log:
        number = 0
        for passed in range(0, int(hours * 3600e6), 10_000):
            for channel, (period, encoding) in kinds.items():
                if passed % period == 0:
                    utime = START_US + passed
                    log.write(struct.pack(">IqqII", 0xEDA1DA01, number, utime, len(channel), len(encoding)))
                    log.write(channel.encode() + encoding[:8] + struct.pack(">q", utime) + encoding[16:])
                    number += 1


def main():
    hours = float(sys.argv[1]) if len(sys.argv) > 1 else 1.0
    robots = int(sys.argv[2]) if len(sys.argv) > 2 else 100
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log.lcmlog"
        write_log(log, hours, robots)
        print(f"{hours:g} h of {robots} robots, log of {log.stat().st_size / 1e9:.2f} GB, load {os.getloadavg()[0]:.1f}")
        for _ in range(3):
            subprocess.run([sys.executable, "-c", MEASURE, log], check=True)


if __name__ == "__main__":
    main()
