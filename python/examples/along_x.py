"""All robots turn until they head along x: lab run experiments/abp.toml --virtual-time --with along_x.py"""
import active_lab

with active_lab.Lab() as lab:
    for frame in lab.frames(seconds=60):
        for robot in frame.robots:
            lab.drive(robot.robot_id, forward=0.05, turn=-2 * robot.theta)
