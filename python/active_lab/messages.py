"""The messages of the lab as Python classes, one for each type in lcmtypes/.

    command = messages.robot_command_t(lease_ms=500, orders=[...])
    messages.decode(command.encode()).orders[0].robot_ids

Every class has the fields of its type, in SI units, as attributes; `help(messages.robot_state_t)` lists
them with their units. The constants are attributes of the class: `messages.robot_order_t.DRIVE`. Fields
that are not given are 0, "", or empty. The counts (`num_robots`) follow from the lists; you need not set
them. The classes are made from the same definitions as the C++ ones, so there is nothing to generate.
"""
from typing import Any, Dict, Optional, Type

from . import _core


class Message:
    """Base of all messages: keyword arguments set fields; see encode(), decode() and to_dict()."""

    __slots__ = ()
    type_name = ""
    _defaults: Dict[str, Any] = {}

    def __init__(self, **values: Any) -> None:
        for name, default in self._defaults.items():
            setattr(self, name, default() if callable(default) else default)
        for name, value in values.items():
            if name not in self._defaults:
                raise TypeError(f"{self.type_name} has no field {name}; it has "
                                + ", ".join(self._defaults))
            setattr(self, name, value)

    def encode(self) -> bytes:
        """The message in LCM's encoding. Raises ValueError that names the field that is wrong."""
        return _core.encode(self.type_name, self)

    @classmethod
    def decode(cls, encoding: bytes) -> "Message":
        """The message with this encoding; raises ValueError if it is of another type, or damaged."""
        message = _core.decode(encoding)
        if not isinstance(message, cls):
            raise ValueError(f"found a {message.type_name}, expected a {cls.type_name}")
        return message

    def to_dict(self) -> Dict[str, Any]:
        """The message as plain dicts and lists."""
        return {name: _plain(getattr(self, name)) for name in self._defaults}

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self.encode() == other.encode()  # type: ignore[attr-defined]

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={_short(getattr(self, name))}" for name in self._defaults)
        return f"{self.type_name}({values})"


def _plain(value: Any) -> Any:
    if isinstance(value, Message):
        return value.to_dict()
    if isinstance(value, list):
        return [_plain(element) for element in value]
    return value


def _short(value: Any) -> str:
    if isinstance(value, list) and len(value) > 3:
        return f"[{value[0]!r}, ... {len(value)} in all]"
    text = repr(value)
    return text if len(text) <= 200 else text[:200] + "..."


def _default(field: Dict[str, Any], types: Dict[str, Any]) -> Any:
    kind = field["type"]
    if field["array"]:
        if kind == "byte":
            return b"" if field["count_field"] >= 0 else bytes(field["count"])
        if field["count_field"] >= 0:
            return list
        one = _default({**field, "array": False}, types)
        return lambda: [one() if callable(one) else one for _ in range(field["count"])]
    if kind == "string":
        return ""
    if kind == "boolean":
        return False
    if kind in ("float", "double"):
        return 0.0
    if kind in types:
        return lambda: globals()[kind]()
    return 0


def _documentation(entry: Dict[str, Any]) -> str:
    lines = [entry["comment"], ""]
    for field in entry["fields"]:
        count = ""
        if field["array"]:
            index = field["count_field"]
            count = "[" + (entry["fields"][index]["name"] if index >= 0 else str(field["count"])) + "]"
        unit = f" [{field['unit']}]" if field["unit"] else ""
        lines.append(f"{field['name']}{count}: {field['type']}{unit} {field['comment']}".rstrip())
        for name, value, comment in field["constants"]:
            lines.append(f"    {name} = {value}  {comment}".rstrip())
    return "\n".join(lines)


def _make() -> Dict[str, Type[Message]]:
    schema = _core.schema()
    made: Dict[str, Type[Message]] = {}
    for name, entry in schema.items():
        fields = entry["fields"]
        values: Dict[str, Any] = {
            "__slots__": tuple(field["name"] for field in fields),
            "__doc__": _documentation(entry),
            "__module__": __name__,
            "type_name": name,
            "_defaults": {field["name"]: _default(field, schema) for field in fields},
        }
        for field in fields:
            values.update({constant: value for constant, value, _ in field["constants"]})
        made[name] = type(name, (Message,), values)
    return made


#: All message classes by name.
types: Dict[str, Type[Message]] = _make()
globals().update(types)
_core.set_classes(types)


def decode(encoding: bytes) -> Message:
    """The message with this encoding, of whatever type; raises ValueError if it is unknown or damaged."""
    return _core.decode(encoding)


def type_of(encoding: bytes) -> Optional[str]:
    """The name of an encoding's type; None: it is unknown."""
    return _core.type_of(encoding)


__all__ = ["Message", "decode", "type_of", "types", *types]
