"""A running lab in a program: receive its messages, set its light, drive its robots."""
import itertools
import json
import math
import operator
import os
import sys
from collections import deque
from functools import cached_property
from pathlib import Path
from typing import Any, Callable, Deque, Dict, Iterator, List, NamedTuple, Optional, Sequence, Union

from . import _core, messages as msg
from .lockstep import LOCKSTEP, LockstepBus
from .messages import Message

_LIGHT_REPEAT_US = 500_000  # a light that is not repeated expires after 2.5 s
_DRIVE_REPEAT_US = 200_000
_STOP_REPEAT_US = 100_000
_REQUEST_REPEAT_US = 200_000
_HEARTBEAT_US = 1_000_000
_LEASE_MS = 500  # a robot stops this long after the program has fallen silent
_ANSWER_US = 5_000_000
_SILENT_US = 10_000_000
_FOREVER = 2**62
_RUNNERS = ("lab", "replay")  # senders of EXPERIMENT_STATUS

#: In virtual time a start time would be the same for two connections of one program.
_instances = itertools.count(2)  # services have 1 in virtual time

#: {"kind": "disk", "x_cm": 60, ...} as in experiment files, the same as TOML text, or a number: uniform.
Layer = Union[float, str, Dict[str, Any]]


class Refused(RuntimeError):
    """The lab has refused what was asked; the text says why."""


class RunningLab(NamedTuple):
    name: str
    url: str  #: of its bus
    directory: str  #: of its run
    replay: bool  #: a log that is played: there are no robots


def running_labs() -> List[RunningLab]:
    """The labs of this user that run on this machine."""
    return [RunningLab(**lab) for lab in _core.running_labs()]


class Received(NamedTuple):
    """A message that has arrived."""

    channel: str
    message: Any


class Lab:
    """A lab that runs: live on this machine, or in virtual time under `lab run FILE --with script.py`.

        with active_lab.Lab() as lab:
            for frame in lab.frames(seconds=60):
                nearest = min(frame.robots, key=lambda robot: robot.x)
                lab.light({"kind": "disk", "x_cm": 100 * nearest.x, "y_cm": 100 * nearest.y,
                           "radius_cm": 10, "intensity": 1})

    name: of the lab, needed if several run. url: of a bus, instead of a lab. sender: the name under which
    this program speaks, "script" if there is none.

    What is set (light, driven robots) is kept up while the program waits for messages, sleeps, or runs
    run(). A program that hangs or ends loses it: a robot stops after 0.5 s and returns to the lab, a light
    goes after 2.5 s. In virtual time the lab waits while the program computes, so the same program gives
    the same run every time.
    """

    def __init__(self, name: Optional[str] = None, url: Optional[str] = None, sender: Optional[str] = None) -> None:
        self.name = name or ""
        #: Folder of the run; None: it is not known.
        self.directory: Optional[Path] = None
        self.sender = sender or Path(sys.argv[0] or "script").stem or "script"
        self._bus = self._connect(name, url)
        #: Whether time is virtual.
        self.virtual: bool = isinstance(self._bus, LockstepBus)
        self._instance = next(_instances) if self.virtual else self._bus.now
        self._started = self._bus.now
        #: Whether the run is over.
        self.ended = False
        #: Messages that arrived while the program was busy and that frames() has left out.
        self.skipped = 0
        self._sent: Dict[str, int] = {}
        self._seq: Dict[str, int] = {}
        self._handlers: Dict[str, List[Callable[[Any], None]]] = {}
        self._queue: Deque[Received] = deque()
        self._wanted: Dict[str, int] = {}
        #: Calls of drive() that were beyond the wheels' limit.
        self.limited = 0
        #: Messages (and robots in messages) of each channel that were refused: damaged, impossible.
        self.refused: Dict[str, int] = {}
        self._first_refused = ""
        self._latest: Dict[str, bytes] = {}  # checked encodings, decoded when somebody looks
        self._decoded: Dict[str, Any] = {}
        self._timers: List[List[Any]] = []  # [due, period, callback]
        self._light: Optional[msg.light_command_t] = None
        self._light_due = 0
        self._orders: Dict[int, msg.robot_order_t] = {}
        self._orders_changed = False
        self._orders_due = 0
        self._heartbeat_due = self._bus.now
        self._heard = self._bus.now
        self._refusal: Optional[str] = None
        self._closed = False
        for channel in ("EXPERIMENT_STATUS", "LIGHT_STATUS", "ROBOT_STATUS", "TRACKED_FRAME", "ROBOT_COMMAND"):
            self._bus.subscribe(channel)

    def _connect(self, name: Optional[str], url: Optional[str]) -> Any:
        if url is None and name is None and os.environ.get(LOCKSTEP):
            self._set_directory(os.environ.get("ACTIVE_LAB_DIRECTORY", ""))
            return LockstepBus(int(os.environ[LOCKSTEP]))
        if url is None and name is None and os.environ.get("ACTIVE_LAB_URL"):
            self._set_directory(os.environ.get("ACTIVE_LAB_DIRECTORY", ""))
            return _core.LiveBus(os.environ["ACTIVE_LAB_URL"])
        if url is not None:
            return _core.LiveBus(url)
        labs = running_labs()
        if name is not None:
            labs = [lab for lab in labs if name in (lab.name, lab.directory)]
        if not labs:
            named = "no lab" if name is None else f"no lab named {name}"
            raise ConnectionError(f"{named} runs on this machine; start one (lab run FILE), or let it start "
                                  "this program: lab run FILE --with SCRIPT")
        if len(labs) > 1:
            raise ConnectionError("several labs run: " + ", ".join(lab.name for lab in labs)
                                  + "; say which: active_lab.Lab(NAME)")
        self.name = labs[0].name
        self._set_directory(labs[0].directory)
        return _core.LiveBus(labs[0].url)

    def _set_directory(self, directory: str) -> None:
        if directory:
            self.directory = Path(directory)
            self.name = self.name or self.directory.name

    def __enter__(self) -> "Lab":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    # --- time ---

    @property
    def utime(self) -> int:
        """Now [us since 1970], virtual time included."""
        return int(self._bus.now)

    @property
    def t(self) -> float:
        """Seconds since this program connected."""
        return (self._bus.now - self._started) / 1e6

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

    @cached_property
    def experiment(self) -> Dict[str, Any]:
        """The effective experiment file; keys as in experiment files."""
        if self.directory is None:
            raise KeyError("the experiment of this lab is not known: it was named by the URL of its bus")
        import tomllib

        return tomllib.loads((self.directory / "experiment.toml").read_text(encoding="utf-8"))

    def _last(self, channel: str) -> Any:
        encoding = self._latest.get(channel)
        if encoding is None:
            return None
        if channel not in self._decoded:
            self._decoded[channel] = msg.decode(encoding)
        return self._decoded[channel]

    # --- receiving ---

    def subscribe(self, channel: str, handler: Callable[[Any], None]) -> None:
        """Calls handler(message) for every message on a channel, while this program waits for anything."""
        self._bus.subscribe(channel)
        self._handlers.setdefault(channel, []).append(handler)

    def every(self, seconds: float, callback: Callable[[], None]) -> None:
        """Calls callback() again and again, for the first time after `seconds`."""
        if not seconds > 0:
            raise ValueError(f"every(): found {seconds} s, expected more than 0")
        period = round(seconds * 1e6)
        self._timers.append([self._bus.now + period, period, callback])

    def messages(self, *channels: str, seconds: Optional[float] = None) -> Iterator[Received]:
        """The messages on these channels as they arrive: (channel, message). Ends with the run, or after
        `seconds`."""
        until = self._until(seconds)
        for channel in channels:
            self._bus.subscribe(channel)
            self._wanted[channel] = self._wanted.get(channel, 0) + 1
        try:
            while True:
                while self._queue:
                    if self._queue[0].channel in channels:
                        yield self._queue.popleft()
                    else:
                        self._queue.popleft()
                if self.ended or not self._step(until):
                    return
        finally:
            for channel in channels:
                self._wanted[channel] -= 1

    def frames(self, seconds: Optional[float] = None, every: bool = False) -> Iterator["msg.tracked_frame_t"]:
        """The camera frames (tracked_frame_t) as they arrive. Ends with the run, or after `seconds`.

        A live program that is slower than the camera gets the newest frame, and `skipped` counts those
        left out; every=True gives all."""
        for received in self.messages("TRACKED_FRAME", seconds=seconds):
            if not every and not self.virtual:
                while self._bus.waiting and self._step(0):
                    pass
                newest = received
                while self._queue:
                    waiting = self._queue.popleft()
                    if waiting.channel == "TRACKED_FRAME":
                        newest, self.skipped = waiting, self.skipped + 1
                received = newest
            yield received.message

    def sleep(self, seconds: float) -> None:
        """Waits, while handlers are called and what was set is kept up."""
        until = self._until(seconds)
        while not self.ended and self._step(until):
            self._queue.clear()

    def run(self, seconds: Optional[float] = None) -> None:
        """Calls handlers and timers until the run ends, or for `seconds`."""
        self.sleep(math.inf if seconds is None else seconds)

    def wait_for(self, condition: Callable[["Lab"], Any], seconds: float = 5.0) -> bool:
        """Waits until condition(lab) holds; False: it did not within `seconds`."""
        until = self._until(seconds)
        while not condition(self):
            if self.ended or not self._step(until):
                return bool(condition(self))
        return True

    def _until(self, seconds: Optional[float]) -> int:
        if seconds is None or math.isinf(seconds):
            return _FOREVER
        return int(self._bus.now + round(seconds * 1e6))

    def _step(self, until: int) -> bool:
        """Handles one message or one timer. False: `until` has been reached, or the run is over."""
        self._send_due()
        now = self._bus.now
        due = min([until, self._next_due()] + [timer[0] for timer in self._timers])
        if not self.virtual:
            due = min(due, self._heard + _SILENT_US)
        received = self._bus.receive(max(due, now))
        if received is None:
            if self.virtual and self._bus.over:
                self.ended = True
                return False
            for timer in self._timers:
                if timer[0] <= self._bus.now:
                    timer[0] += timer[1] * (1 + (self._bus.now - timer[0]) // timer[1])
                    timer[2]()
            if not self.virtual and self._bus.now >= self._heard + _SILENT_US:
                raise TimeoutError(f"nothing was heard from the lab for {_SILENT_US / 1e6:.0f} s")
            return bool(self._bus.now < until)
        self._take(*received)
        return True

    def _take(self, channel: str, _received_utime: int, encoding: bytes) -> None:
        self._heard = self._bus.now
        usable, problem, removed = _core.checked(encoding)
        if problem:
            self._refuse(channel, problem, max(1, removed))
        if usable is None:
            return
        problem = _foreign(channel, usable)
        if problem:
            self._refuse(channel, problem)
            return
        self._latest[channel] = usable
        self._decoded.pop(channel, None)
        if channel == "EXPERIMENT_STATUS":
            status = self._last(channel)
            self.ended = self.ended or status.phase == status.ENDED
        elif channel == "LIGHT_STATUS" and self._light is not None:
            self._check_refusal(self._last(channel).last_refusal)
        if self._wanted.get(channel, 0) > 0:
            self._queue.append(Received(channel, self._last(channel)))
        for handler in self._handlers.get(channel, []):
            handler(self._last(channel))

    def _refuse(self, channel: str, problem: str, count: int = 1) -> None:
        """Counts for the heartbeat, as the lab's services do."""
        self.refused[channel] = self.refused.get(channel, 0) + count
        self._first_refused = self._first_refused or f"{channel} refused: {problem}"

    def _check_refusal(self, refusal: str) -> None:
        prefix = f"LIGHT_COMMAND {self._seq.get('LIGHT_COMMAND', 0)} of {self.sender}: "
        if refusal.startswith(prefix):
            self._light = None
            raise Refused("light: " + refusal[len(prefix):])

    # --- sending ---

    def publish(self, channel: str, message: Message, seq: Optional[int] = None) -> None:
        """Sends any message. utime (if it is 0), sender, instance and seq are filled in.

        seq: of a command that is repeated unchanged the number that it had; None: counts the messages."""
        if seq is None:
            seq = self._seq[channel] = self._seq.get(channel, 0) + 1
        message.sender, message.instance, message.seq = self.sender, self._instance, seq  # type: ignore[attr-defined]
        if message.utime == 0:  # type: ignore[attr-defined]
            message.utime = self.utime  # type: ignore[attr-defined]
        self._bus.publish(channel, message.encode())
        self._sent[channel] = self._sent.get(channel, 0) + 1

    def light(self, layers: Union[Layer, Sequence[Layer]], ramp: float = 0.0, label: str = "", wait: float = 0.0) -> None:
        """Sets the light of the arena, above the script's, until release_light() or the program's end.

        layers: 0 to 1 for uniform light; a layer with the keys of experiment files, as a dict or as TOML
            text; or a list of layers, painted one over the other (docs/light.md).
        ramp: [s] of the cross-fade. wait: [s] for the light to be on the arena; 0: go on at once.
        Raises LayerError if a layer is wrong, Refused if the projector refuses it (perhaps later, while
        the program waits for something)."""
        listed = [layers] if isinstance(layers, (int, float, str, dict)) else list(layers)
        command = msg.light_command_t.decode(
            _core.light_command([_toml_layer(layer) for layer in listed], self.directory))
        command.priority, command.from_utime = command.MANUAL, self.utime
        command.ramp, command.label = ramp, label or self.sender
        self._set_light(command)
        if wait > 0 and not self.wait_for(Lab._is_light_shown, wait):
            raise TimeoutError(f"the light was not on the arena within {wait} s")

    def release_light(self) -> None:
        """Returns the light to the script."""
        if self._light is not None:
            self._set_light(msg.light_command_t(priority=msg.light_command_t.MANUAL,
                                                     from_utime=self.utime, release=1))
            self._light = None

    def _set_light(self, command: "msg.light_command_t") -> None:
        self._light = command
        self._seq["LIGHT_COMMAND"] = self._seq.get("LIGHT_COMMAND", 0) + 1
        self._send_light()

    def _send_light(self) -> None:
        if self._light is None:
            return
        self._light.utime = 0
        self._light_due = self.utime + _LIGHT_REPEAT_US
        self.publish("LIGHT_COMMAND", self._light, self._seq["LIGHT_COMMAND"])

    def _is_light_shown(self) -> bool:
        status = self._last("LIGHT_STATUS")
        return (status is not None and status.commander == self.sender
                and status.command_instance == self._instance
                and status.command_seq == self._seq["LIGHT_COMMAND"])

    def drive(self, robot_id: int, forward: float = 0.0, turn: float = 0.0, *, left: Optional[float] = None,
              right: Optional[float] = None) -> None:
        """Drives a robot until the next order for it: forward [m/s] and turn [rad/s] (counter-clockwise),
        or its wheels, left and right [m/s]. Wheels faster than robot.max_wheel_speed_cm_s of the experiment
        are scaled down, both alike, so that the path keeps its curvature; `limited` counts such calls. The
        robot obeys until release(), or stops 0.5 s after the program has fallen silent. Orders are sent when
        the program next waits, all robots in one message."""
        if (left is None) != (right is None):
            raise ValueError("drive(): found one wheel, expected left and right")
        if left is None or right is None:
            half = self._wheel_base / 2
            left, right = forward - turn * half, forward + turn * half
        if not (math.isfinite(left) and math.isfinite(right)):
            raise ValueError(f"drive(): found {left} and {right} m/s, expected finite speeds")
        fastest = max(abs(left), abs(right))
        if fastest > self._max_wheel_speed:
            share = self._max_wheel_speed / fastest
            left, right = left * share, right * share
            self.limited += 1
        self._order(robot_id, msg.robot_order_t(mode=msg.robot_order_t.DRIVE, wheel_left=left,
                                                     wheel_right=right))

    def stand(self, robot_id: int) -> None:
        """Lets a robot stand, until the next order for it or release()."""
        self._order(robot_id, msg.robot_order_t(mode=msg.robot_order_t.STAND))

    def program(self, robot_id: int, name: str) -> None:
        """Lets a robot run a program of the experiment in any light, until the next order or release()."""
        self.wait_for(lambda lab: lab._programs(), 2.0)
        known = self._programs()
        if name not in known:
            raise KeyError(f"no robot of this lab runs a program {name!r}; they run " + ", ".join(known))
        order, band = known[name]
        single = msg.light_band_t(low=0.0, high=1.0, program=band.program)
        self._order(robot_id, msg.robot_order_t(
            mode=msg.robot_order_t.TABLE, light_sensor=order.light_sensor, hysteresis=order.hysteresis,
            bands=[single], reverse_on=order.reverse_on, reverse_distance=order.reverse_distance,
            reverse_speed=order.reverse_speed))

    def release(self, robot_id: Optional[int] = None) -> None:
        """Returns a robot (None: all) to the light table of the lab."""
        for one in list(self._orders) if robot_id is None else [robot_id]:
            if self._orders.pop(one, None) is not None:
                self._orders_changed = True

    def _programs(self) -> Dict[str, Any]:
        """The programs in the lab's own light table: name -> (order, band)."""
        command = self._last("ROBOT_COMMAND")
        if command is not None and command.sender != self.sender:
            self._table = {band.program.id.name: (order, band) for order in command.orders for band in order.bands
                           if order.mode == order.TABLE and band.program.text} or getattr(self, "_table", {})
        return getattr(self, "_table", {})

    def _order(self, robot_id: int, order: "msg.robot_order_t") -> None:
        try:
            known = 0 <= operator.index(robot_id) < 2**31
        except TypeError:
            known = False
        if not known:
            raise ValueError(f"found the robot {robot_id!r}, expected the id of a robot, a whole number from 0")
        robot_id = operator.index(robot_id)
        order.robot_ids = [robot_id]
        before = self._orders.get(robot_id)
        if before is None or before != order:
            self._orders[robot_id] = order
            self._orders_changed = True

    @cached_property
    def _wheel_base(self) -> float:
        try:
            return float(self.experiment.get("robot", {}).get("diameter_cm", 7.5)) / 100
        except (KeyError, OSError):
            return 0.075

    @cached_property
    def _max_wheel_speed(self) -> float:
        """[m/s]; infinite: not known, a robot then refuses what is beyond its limit."""
        try:
            return float(self.experiment["robot"]["max_wheel_speed_cm_s"]) / 100
        except (KeyError, OSError):
            return math.inf

    def _send_orders(self) -> None:
        self._orders_changed = False
        self._orders_due = self.utime + _DRIVE_REPEAT_US
        if self._orders:
            command = msg.robot_command_t(lease_ms=_LEASE_MS, orders=list(self._orders.values()))
            self.publish("ROBOT_COMMAND", command, self._seq["ROBOT_COMMAND"])

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

    # --- keeping up what was set ---

    def _next_due(self) -> int:
        due = self._heartbeat_due
        if self._light is not None:
            due = min(due, self._light_due)
        if self._orders:
            due = min(due, self._orders_due)
        return due

    def _send_due(self) -> None:
        now = self._bus.now
        if self._orders_changed:
            self._seq["ROBOT_COMMAND"] = self._seq.get("ROBOT_COMMAND", 0) + 1
            self._send_orders()
        elif self._orders and self._orders_due <= now:
            self._send_orders()
        if self._light is not None and self._light_due <= now:
            self._send_light()
        if self._heartbeat_due <= now:
            self._heartbeat_due = now + _HEARTBEAT_US
            self._beat(msg.service_status_t.READY)

    def _beat(self, state: int) -> None:
        """SERVICE_STATUS with the counts of what was sent, from which the report counts losses."""
        counts = dict(self._sent)
        counts["SERVICE_STATUS"] = counts.get("SERVICE_STATUS", 0) + 1
        self.publish("SERVICE_STATUS", msg.service_status_t(
            state=state, host="" if self.virtual else os.uname().nodename, pid=0 if self.virtual else os.getpid(),
            version=_core.version, contract_version=_core.contract_version, start_utime=self._started,
            sent=[msg.channel_count_t(channel=channel, messages=count)
                  for channel, count in sorted(counts.items())],
            received=[msg.stream_count_t(channel=channel, decode_errors=count)
                      for channel, count in sorted(self.refused.items())], last_error=self._first_refused))

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
        return f"<Lab {self.name or 'by URL'}, {how}{', over' if self.ended else ''}>"


def _foreign(channel: str, encoding: bytes) -> str:
    """Why a message is not what the lab sends on this channel; empty: it is."""
    expected = f"{channel.lower()}_t"
    found = msg.type_of(encoding)
    if expected in msg.types and found != expected:
        return f"found a {found}, expected a {expected}"
    if channel == "EXPERIMENT_STATUS":
        sender = msg.decode(encoding).sender  # type: ignore[attr-defined]
        if sender not in _RUNNERS:
            return f"sender: found {sender!r}, expected " + " or ".join(_RUNNERS)
    return ""


def _toml_layer(layer: Layer) -> str:
    if isinstance(layer, dict):
        return "{" + ", ".join(f"{key} = {_toml(value)}" for key, value in layer.items()) + "}"
    if isinstance(layer, (int, float)):
        return f"{{kind = \"uniform\", intensity = {_toml(float(layer))}}}"
    return str(layer)


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, dict):
        return _toml_layer(value)
    if hasattr(value, "__len__"):
        return "[" + ", ".join(_toml(element) for element in value) + "]"
    if isinstance(value, int) or hasattr(value, "__index__"):
        return str(int(value))
    number = float(value)
    if math.isnan(number):
        return "nan"
    return repr(number) if math.isfinite(number) else ("inf" if number > 0 else "-inf")
