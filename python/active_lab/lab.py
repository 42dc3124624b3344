"""A running lab in a program: receive its messages, set its light, drive its robots."""
from typing import Any, Dict, Optional

from . import _core
from . import messages as msg
from .light_control import LightControl, Refused
from .robot_control import RobotControl
from .running_labs import connect

_STOP_REPEAT_US = 100_000
_REQUEST_REPEAT_US = 200_000
_ANSWER_US = 5_000_000


class Lab(RobotControl, LightControl):
    """A lab that runs: live on this machine, or in virtual time under `lab run FILE --with script.py`.

        with active_lab.Lab() as lab:
            for frame in lab.frames(seconds=60):
                nearest = min(frame.robots, key=lambda robot: robot.x)
                lab.light({"kind": "disk", "x_cm": 100 * nearest.x, "y_cm": 100 * nearest.y,
                           "radius_cm": 10, "intensity": 1})

    name: of the lab, needed if several run. url: of a bus, instead of a lab. sender: the name under which
    this program speaks, at most 63 bytes; None: that of its file, cut to this length.

    What is set (light, driven robots) is kept up while the program waits for messages, sleeps, or runs
    run(). A program that hangs or ends loses it: a robot stops after 0.5 s and returns to the lab, a light
    goes after 2.5 s. In virtual time the lab waits while the program computes, so the same program gives
    the same run every time.
    """

    def __init__(self, name: Optional[str] = None, url: Optional[str] = None, sender: Optional[str] = None) -> None:
        super().__init__(connect(name, url), sender)

    def __enter__(self) -> "Lab":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    # --- what is known of the lab ---

    @property
    def frame(self) -> Optional["msg.tracked_frame_t"]:
        """The last camera frame; None: there was none yet."""
        return self._last("TRACKED_FRAME")

    @property
    def poses(self) -> Dict[int, "msg.tracked_pose_t"]:
        """The poses of the last camera frame by robot_id: x, y [m], theta [rad]."""
        frame = self.frame
        return {} if frame is None else {robot.robot_id: robot for robot in frame.robots}

    @property
    def states(self) -> Dict[int, "msg.robot_state_t"]:
        """What the robots reported last, by robot_id: program, light, wheel speeds, flags, battery."""
        status = self._last("ROBOT_STATUS")
        return {} if status is None else {robot.robot_id: robot for robot in status.robots}

    @property
    def status(self) -> Optional["msg.experiment_status_t"]:
        """Phase, step, time left of the experiment."""
        return self._last("EXPERIMENT_STATUS")

    # --- requests ---

    def stop(self, reason: str = "", seconds: float = 5.0) -> None:
        """Stops every robot at once, until release_stop(), whoever calls it. Returns when all have
        confirmed; raises TimeoutError otherwise."""
        self._ask_stop(0, reason, seconds)

    def release_stop(self, reason: str = "", seconds: float = 5.0) -> None:
        """Releases a stop, of this program or of others."""
        self._ask_stop(1, reason, seconds)

    def _ask_stop(self, clear: int, reason: str, seconds: float) -> None:
        seq = self.utime
        request = msg.robot_stop_t(clear=clear, reason=reason or f"asked by {self.sender}")
        until = self._until(seconds)

        def obeys(state: Any) -> bool:
            return state.stop_seq == seq or (state.flags & state.FLAG_STOPPED == 0) == bool(clear)

        while self.utime < until and not self.ended:
            request.utime = 0
            self.publish("ROBOT_STOP", request, seq)
            asked = self.utime
            self.sleep(_STOP_REPEAT_US / 1e6)
            status = self._last("ROBOT_STATUS")
            if status is not None and status.utime > asked and all(obeys(robot) for robot in status.robots):
                return
        raise TimeoutError("not every robot has confirmed the " + ("release of the stop" if clear else "stop"))

    def mark(self, text: str) -> None:
        """Writes a remark into the record of the run."""
        self._request(msg.experiment_command_t.MARK, text)

    def pause(self) -> None:
        """Stops the clock of the script. The light stays, robots keep moving."""
        self._request(msg.experiment_command_t.PAUSE)

    def resume(self) -> None:
        """The script continues."""
        self._request(msg.experiment_command_t.RESUME)

    def end(self, why: str = "") -> None:
        """Ends the run as Ctrl-C does: the data are kept, the report is made."""
        self._request(msg.experiment_command_t.END, why or f"ended by {self.sender}")

    def _request(self, action: int, text: str = "") -> None:
        seq = self._seq["EXPERIMENT_COMMAND"] = self._seq.get("EXPERIMENT_COMMAND", 0) + 1
        request = msg.experiment_command_t(action=action, text=text)
        request.utime = self.utime

        def answered(lab: "Lab") -> bool:
            status = lab._last("EXPERIMENT_STATUS")
            return (status is not None and status.commander == lab.sender
                    and status.command_instance == lab._instance and status.command_seq == seq)

        for _ in range(_ANSWER_US // _REQUEST_REPEAT_US):
            self.publish("EXPERIMENT_COMMAND", request, seq)
            if self.wait_for(answered, _REQUEST_REPEAT_US / 1e6):
                refusal = self._last("EXPERIMENT_STATUS").refusal
                if refusal:
                    raise Refused(refusal)
                return
            if self.ended:
                return
        raise TimeoutError("the lab has not answered within 5 s")

    def close(self) -> None:
        """Gives up the light and the robots. Called at the end of a with block."""
        if self._closed:
            return
        self._closed = True
        try:
            if self._orders:
                self.release()
            if self._light is not None:
                self.release_light()
            for _ in range(5):
                self._beat(msg.service_status_t.ENDED)
        except OSError:  # the lab has gone before
            pass
        if self.virtual:
            self._bus.close()

    def __repr__(self) -> str:
        how = "virtual time" if self.virtual else "live"
        return f"<Lab {_core.printable(self.name) or 'by URL'}, {how}{', over' if self.ended else ''}>"
