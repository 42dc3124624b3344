"""The light of a running lab, set by a program."""
import json
import math
from typing import Any, Dict, Optional, Sequence, Union

from . import _core, messages as msg
from .bus_client import BusClient
from .running_labs import Connection

_REPEAT_US = 500_000  # a light that is not repeated expires after 2.5 s

#: {"kind": "disk", "x_cm": 60, ...} as in experiment files, the same as TOML text, or a number: uniform.
Layer = Union[float, str, Dict[str, Any]]


class Refused(RuntimeError):
    """The lab has refused what was asked; the text says why."""


class LightControl(BusClient):
    """Sets the light and keeps it up."""

    def __init__(self, connection: Connection, sender: Optional[str]) -> None:
        super().__init__(connection, sender)
        self._light: Optional[msg.light_command_t] = None
        self._light_due = 0

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
        if wait > 0 and not self.wait_for(LightControl._is_light_shown, wait):
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
        self._light_due = self.utime + _REPEAT_US
        self.publish("LIGHT_COMMAND", self._light, self._seq["LIGHT_COMMAND"])

    def _is_light_shown(self) -> bool:
        status = self._last("LIGHT_STATUS")
        return (status is not None and status.commander == self.sender
                and status.command_instance == self._instance
                and status.command_seq == self._seq["LIGHT_COMMAND"])

    def _look_at(self, channel: str) -> None:
        super()._look_at(channel)
        if channel == "LIGHT_STATUS" and self._light is not None:
            self._check_refusal(self._last(channel).last_refusal)

    def _check_refusal(self, refusal: str) -> None:
        prefix = f"LIGHT_COMMAND {self._seq.get('LIGHT_COMMAND', 0)} of {self.sender}: "
        if refusal.startswith(prefix):
            self._light = None
            raise Refused("light: " + refusal[len(prefix):])

    def _next_due(self) -> int:
        due = super()._next_due()
        return due if self._light is None else min(due, self._light_due)

    def _send_due(self) -> None:
        if self._light is not None and self._light_due <= self._bus.now:
            self._send_light()
        super()._send_due()


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
