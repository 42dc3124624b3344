"""The robots of a running lab, driven by a program."""
import math
import operator
from functools import cached_property
from typing import Any, Dict, Optional

from . import messages as msg
from .bus_client import BusClient
from .running_labs import Connection

_REPEAT_US = 200_000
_LEASE_MS = 500  # a robot stops this long after the program has fallen silent


class RobotControl(BusClient):
    """Gives robots orders and keeps them up."""

    def __init__(self, connection: Connection, sender: Optional[str]) -> None:
        super().__init__(connection, sender)
        #: Calls of drive() that were beyond the wheels' limit.
        self.limited = 0
        self._orders: Dict[int, msg.robot_order_t] = {}
        self._orders_changed = False
        self._orders_due = 0

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
        self._orders_due = self.utime + _REPEAT_US
        if self._orders:
            command = msg.robot_command_t(lease_ms=_LEASE_MS, orders=list(self._orders.values()))
            self.publish("ROBOT_COMMAND", command, self._seq["ROBOT_COMMAND"])

    def _next_due(self) -> int:
        due = super()._next_due()
        return min(due, self._orders_due) if self._orders else due

    def _send_due(self) -> None:
        if self._orders_changed:
            self._seq["ROBOT_COMMAND"] = self._seq.get("ROBOT_COMMAND", 0) + 1
            self._send_orders()
        elif self._orders and self._orders_due <= self._bus.now:
            self._send_orders()
        super()._send_due()
