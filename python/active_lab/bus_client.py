"""A program on the bus of a lab: receives and sends messages, keeps time, and says that it is alive."""
import itertools
import math
import os
import sys
from collections import deque
from functools import cached_property
from pathlib import Path
from typing import Any, Callable, Deque, Dict, Iterator, List, NamedTuple, Optional

from . import _core, messages as msg
from .lockstep import LockstepBus
from .messages import Message
from .running_labs import Connection

_HEARTBEAT_US = 1_000_000
_SILENT_US = 10_000_000
_FOREVER = 2**62
_RUNNERS = ("lab", "replay")  # senders of EXPERIMENT_STATUS

#: In virtual time a start time would be the same for two connections of one program.
_instances = itertools.count(2)  # services have 1 in virtual time


class Received(NamedTuple):
    """A message that has arrived."""

    channel: str
    message: Any


class BusClient:
    """The part of Lab that light and robots stand on. What is repeated goes out in _send_due(), whenever the
    program waits."""

    def __init__(self, connection: Connection, sender: Optional[str]) -> None:
        self.sender = _sender_of_argv() if sender is None else _checked_sender(sender)
        self.name = connection.name
        #: Folder of the run; None: it is not known.
        self.directory: Optional[Path] = connection.directory
        self._bus = connection.bus
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
        #: Messages (and robots in messages) of each channel that were refused: damaged, impossible.
        self.refused: Dict[str, int] = {}
        self._first_refused = ""
        self._latest: Dict[str, bytes] = {}  # checked encodings, decoded when somebody looks
        self._decoded: Dict[str, Any] = {}
        self._timers: List[List[Any]] = []  # [due, period, callback]
        self._heartbeat_due = self._bus.now
        self._heard = self._bus.now
        self._closed = False
        for channel in ("EXPERIMENT_STATUS", "LIGHT_STATUS", "ROBOT_STATUS", "TRACKED_FRAME", "ROBOT_COMMAND"):
            self._bus.subscribe(channel)

    # --- time ---

    @property
    def utime(self) -> int:
        """Now [us since 1970], virtual time included."""
        return int(self._bus.now)

    @property
    def t(self) -> float:
        """Seconds since this program connected."""
        return (self._bus.now - self._started) / 1e6

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

    def wait_for(self, condition: Callable[[Any], Any], seconds: float = 5.0) -> bool:
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
        self._look_at(channel)
        if self._wanted.get(channel, 0) > 0:
            self._queue.append(Received(channel, self._last(channel)))
        for handler in self._handlers.get(channel, []):
            handler(self._last(channel))

    def _look_at(self, channel: str) -> None:
        """Takes from a message, the last one of its channel, what concerns the client itself."""
        if channel == "EXPERIMENT_STATUS":
            status = self._last(channel)
            self.ended = self.ended or status.phase == status.ENDED

    def _refuse(self, channel: str, problem: str, count: int = 1) -> None:
        """Counts for the heartbeat, as the lab's services do."""
        self.refused[channel] = self.refused.get(channel, 0) + count
        self._first_refused = self._first_refused or f"{channel} refused: {problem}"

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

    def _next_due(self) -> int:
        """When something has to be sent [us]."""
        return self._heartbeat_due

    def _send_due(self) -> None:
        now = self._bus.now
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


def _size(sender: str) -> int:
    """In a message [bytes]."""
    return len(sender.encode("utf-8", "surrogateescape"))


def _checked_sender(sender: str) -> str:
    if not 0 < _size(sender) <= _core.longest_sender or "\0" in sender:
        raise ValueError(f"sender: found a name of {_size(sender)} bytes, expected 1 to {_core.longest_sender} and "
                         "no byte 0: the lab refuses messages with another one")
    return sender


def _sender_of_argv() -> str:
    sender = Path(sys.argv[0] or "script").stem or "script"
    while _size(sender) > _core.longest_sender:
        sender = sender[:-1]
    return sender


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
