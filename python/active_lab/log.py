"""Logs of LCM messages as tables and as messages."""
import os
from pathlib import Path
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy
import pandas

from . import _core, messages
from .messages import Message

PathLike = Union[str, "os.PathLike[str]"]

#: Columns that a table has beside the fields of its type.
OWN_COLUMNS = ("event", "received_utime", "parent", "message_utime")


class LoggedMessage(NamedTuple):
    """One message of a log."""

    channel: str
    received_utime: int  #: arrival at the recorder [us since 1970]
    message: Message


class Log:
    """Any log in LCM's format: of a run, of `lcm-logger`, of another program.

        log = active_lab.Log("log.lcmlog")
        log.channels                                    # what is in it
        log.table("ROBOT_STATUS", "robots")             # one row per robot and message
        for channel, utime, message in log.messages("EXPERIMENT_EVENT"): ...

    Logs of older versions of the messages are converted while they are read. Damaged places are
    skipped and counted (`damaged_places`). Nothing is read into memory but what you ask for.
    """

    def __init__(self, path: PathLike) -> None:
        self.path = Path(path)
        if not self.path.exists():
            raise FileNotFoundError(f"{self.path}: no such file; expected a log")
        if self.path.is_dir():
            raise IsADirectoryError(f"{self.path} is a folder; expected a log. The folder of a run is "
                                    "opened with active_lab.open()")
        if not self.path.is_file() or not _core.is_log(self.path):
            raise ValueError(f"{self.path}: this is not an LCM log; expected a file that lcm-logger or "
                             "lab run wrote")
        self.files: List[Path] = [Path(file) for file in _core.log_series(self.path)]
        self._index = _core.LogIndex(self.files)
        self._channels = self._index.channels
        self._checks: Dict[Tuple[str, str], "_core.ChannelCheck"] = {}
        #: Number of messages.
        self.message_count: int = self._index.events
        #: Damaged places that were skipped.
        self.damaged_places: int = self._index.damaged_places

    @property
    def channels(self) -> pandas.DataFrame:
        """Channels with their types, numbers of messages, bytes, and times of arrival (UTC)."""
        frame = pandas.DataFrame(self._channels, columns=["channel", "type", "messages", "bytes",
                                                          "first_utime", "last_utime"])
        for end in ("first", "last"):
            frame[end] = pandas.to_datetime(frame.pop(f"{end}_utime"), unit="us", utc=True)
        return frame.set_index("channel")

    @property
    def tables(self) -> pandas.DataFrame:
        """The tables that table() gives: channel, path, columns."""
        rows = [{"channel": entry["channel"], "path": path,
                 "columns": ", ".join(_core.table_columns(entry["type"], path))}
                for entry in self._channels if entry["type"] is not None
                for path in _core.table_paths(entry["type"])]
        return pandas.DataFrame(rows, columns=["channel", "path", "columns"])

    def type_of(self, channel: str) -> str:
        """The name of the type of the messages on a channel."""
        known = [entry for entry in self._channels
                 if entry["channel"] == channel and entry["type"] is not None]
        if not known:
            raise KeyError(f"{self.path} has no messages of a known type on {channel}; it has "
                           + ", ".join(sorted({str(entry["channel"]) for entry in self._channels})))
        return str(max(known, key=lambda entry: entry["messages"])["type"])

    def __contains__(self, channel: str) -> bool:
        return any(entry["channel"] == channel and entry["type"] is not None
                   for entry in self._channels)

    def table(self, channel: str, path: str = "", columns: Optional[Sequence[str]] = None,
              above: Sequence[str] = (), checked: bool = False) -> pandas.DataFrame:
        """A table of one channel.

        path: "" for one row per message; the name of a list for one row per element ("robots"); with a
            dot for a list in a list ("curves.lags"). `tables` lists all.
        columns: the columns that you need; None: all. In an hour of many robots all columns may be more
            than the memory holds.
        above: columns of the tables above that each row gets as well. "seq" is a field of the message,
            "curves.name" one of a list above.
        checked: False: all that was sent. True: as the lab's services and the report read it, without
            messages and robots with numbers that nothing in a lab can measure (nan, a time beyond the
            year 2100, a place more than 1 km away); `.attrs["refused_messages"]` and `.attrs["removed_robots"]`
            count them.

        Units and meanings are in `.attrs["units"]` and `.attrs["descriptions"]`, the names of numbers
        that stand for something in `.attrs["values"]`. Texts are categories. `event` numbers the
        messages of the log, `received_utime` is when the recorder got them, `parent` is the row of the
        table one level above.
        """
        type_name = self.type_of(channel)
        paths = _core.table_paths(type_name)
        if path not in paths:
            raise KeyError(f"{channel} ({type_name}) has no table {path!r}; it has "
                           + ", ".join(repr(one) for one in paths))
        known = _core.table_columns(type_name, path)
        wanted = list(known) if columns is None else list(columns)
        unknown = [name for name in wanted if name not in known]
        if unknown:
            raise KeyError(f"the table {path!r} of {channel} has no column {unknown[0]!r}; it has "
                           + ", ".join(known))
        self._require_memory(channel, path, type_name, wanted)
        needed = wanted + (["parent"] if above and "parent" not in wanted else [])
        check = self._check(channel, type_name) if checked else None
        values, rows, damaged = self._index.table(channel, type_name, path, needed, check)
        series = {name: _column(values[name]) for name in wanted}
        described = {name: known[name] for name in wanted}
        for name in above:
            upper, _, column = name.rpartition(".")
            series[column], described[column] = self._from_above(
                channel, type_name, path, upper, column, numpy.asarray(values["parent"]), check)
        frame = pandas.DataFrame(series, index=pandas.RangeIndex(rows), copy=False)
        frame.attrs.update(
            source=str(self.path), channel=channel, type=type_name, table=path, damaged_messages=damaged,
            units={name: unit for name, (unit, _, _) in described.items() if unit},
            descriptions={name: text for name, (_, text, _) in described.items() if text},
            values={name: names for name, (_, _, names) in described.items() if names})
        if check is not None:
            frame.attrs.update(refused_messages=check.refused, removed_robots=check.removed)
        return frame

    def _check(self, channel: str, type_name: str) -> "_core.ChannelCheck":
        if (channel, type_name) not in self._checks:
            self._checks[channel, type_name] = self._index.check(channel, type_name)
        return self._checks[channel, type_name]

    def _from_above(self, channel: str, type_name: str, path: str, upper: str, column: str,
                    parent: numpy.ndarray, check: Optional["_core.ChannelCheck"]) -> Any:
        """One column of a table above, for every row whose row one level above is `parent`."""
        level = path.rpartition(".")[0]
        if not path or not (upper == "" or level == upper or level.startswith(upper + ".")):
            raise KeyError(f"above: {upper!r} is no table above {path!r}")
        while level != upper:
            values, _, _ = self._index.table(channel, type_name, level, ["parent"], check)
            parent = numpy.asarray(values["parent"])[parent]
            level = level.rpartition(".")[0]
        known = _core.table_columns(type_name, level)
        if column not in known:
            raise KeyError(f"above: the table {upper!r} of {channel} has no column {column!r}; it has "
                           + ", ".join(known))
        values, _, _ = self._index.table(channel, type_name, level, [column], check)
        return _column(values[column]).take(parent), known[column]

    def _require_memory(self, channel: str, path: str, type_name: str, columns: List[str]) -> None:
        try:
            free = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
        except (ValueError, OSError):
            return
        logged = sum(entry["bytes"] for entry in self._channels if entry["channel"] == channel)
        share = len(columns) / max(1, len(_core.table_columns(type_name, path)))
        if logged * share > max(free, 1_000_000_000):
            raise MemoryError(f"this table of {channel} needs about {logged * share / 1e9:.1f} GB, and "
                              f"{free / 1e9:.1f} GB are free: ask for fewer columns with "
                              "table(..., columns=[...])")

    def messages(self, *channels: str) -> Iterator[LoggedMessage]:
        """The messages of these channels (none given: of all), in the order of the log. Messages that
        are damaged or of an unknown type are left out."""
        for channel, utime, encoding in _core.Messages(self.files, set(channels) if channels else None):
            try:
                yield LoggedMessage(channel, utime, messages.decode(encoding))
            except ValueError:
                continue

    def _summary(self) -> str:
        # A log may come from a stranger: control characters of a terminal are shown as text.
        return "\n".join(f"  {_core.printable(entry['channel']):<20} {entry['messages']:>9} "
                         f"{entry['type'] or 'unknown type'}" for entry in self._channels)

    def __repr__(self) -> str:
        return f"<Log {_core.printable(str(self.path))}: {self.message_count} messages>\n{self._summary()}"


def _column(values: Any) -> Any:
    """Codes of texts become categories."""
    if isinstance(values, tuple):
        codes, texts = values
        places: Dict[str, int] = {}
        for text in texts:
            places.setdefault(text, len(places))
        if len(places) != len(texts):  # two texts of bad UTF-8 may look the same
            codes = numpy.array([places[text] for text in texts], dtype=numpy.int32)[codes]
        return pandas.Categorical.from_codes(codes, list(places))
    return values


def label(table: pandas.DataFrame, column: str) -> pandas.Series:
    """The names of the numbers in a column: label(events, "kind") has START, STEP, ..."""
    names: Dict[int, str] = table.attrs.get("values", {}).get(column, {})
    if not names:
        raise KeyError(f"the numbers of {column!r} have no names")
    return table[column].map(names).astype("category")
