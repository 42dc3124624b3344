#!/usr/bin/env python3
"""Prints the last pose of every robot in a log, with Python's standard library alone (docs/formats.md)."""
import struct
import sys


def events(file):
    """(channel, arrival [us since 1970], message) of every event."""
    while head := file.read(28):
        _, _, utime, channel, size = struct.unpack(">IqqII", head)
        yield file.read(channel).decode(), utime, file.read(size)


poses = {}
with open(sys.argv[1], "rb") as log:
    for channel, _, message in events(log):
        if channel != "TRACKED_FRAME":  # lcmtypes/tracked_frame_t.lcm, tracked_pose_t.lcm
            continue
        sender = struct.unpack_from(">I", message, 16)[0]
        at = 20 + sender + 8 + 8 + 1 + 8 + 8  # instance, seq, origin, frame, frame_period
        (count,) = struct.unpack_from(">i", message, at)
        for i in range(count):
            robot, x, y, theta = struct.unpack_from(">iddd", message, at + 4 + 80 * i)
            poses[robot] = x, y, theta
for robot, (x, y, theta) in sorted(poses.items()):
    print(f"robot {robot}: x {x:.3f} m, y {y:.3f} m, theta {theta:.2f} rad")
