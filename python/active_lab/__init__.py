"""Active Lab in Python: runs as tables, and a running lab in a program of yours.

Read a run (docs/python.md):

    import active_lab
    run = active_lab.open("runs/NAME-20260131T120000Z")   # the folder of a run
    run                                                  # what is in it
    run.poses                                            # pandas: t, frame, robot_id, x, y, theta, confidence
    run.poses.attrs["units"]                             # {'x': 'm', ...}
    run.states, run.events, run.analysis, run.curves, run.truth
    run.light.at(run.poses.t, run.poses.x, run.poses.y)  # the light at every pose
    run.table("TRACKED_FRAME", "robots")                 # every field of every message; run.tables lists them
    run.experiment, run.summary, run.films, run.pictures

Any other log: active_lab.Log("log.lcmlog").

Take part in a lab that runs, live or in virtual time (lab run FILE --with script.py):

    with active_lab.Lab() as lab:
        for frame in lab.frames(seconds=60):
            for robot in frame.robots:
                lab.drive(robot.robot_id, forward=0.05, turn=-2 * robot.theta)

Units are SI: m, rad, s. Times `t` are in seconds; `utime` are microseconds since 1970. The arena's origin
is a corner, x along its width, y along its height, theta counter-clockwise from x.
"""
from . import messages
from ._core import contract_version, version as __version__
from .films import Film
from .lab import Lab
from .light_control import Refused
from .log import Log, LoggedMessage, label
from .messages import decode
from .run import Field, Light, Run, open
from .running_labs import running_labs

__all__ = ["Field", "Film", "Lab", "Light", "Log", "LoggedMessage", "Refused", "Run", "__version__",
           "contract_version", "decode", "label", "messages", "open", "running_labs"]
