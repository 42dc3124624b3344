"""The labs that run on this machine, and connecting to the bus of one."""
import os
from pathlib import Path
from typing import Any, List, NamedTuple, Optional

from . import _core
from .lockstep import LOCKSTEP, LockstepBus


class RunningLab(NamedTuple):
    name: str
    url: str  #: of its bus
    directory: str  #: of its run
    replay: bool  #: a log that is played: there are no robots


def running_labs() -> List[RunningLab]:
    """The labs of this user that run on this machine."""
    return [RunningLab(**lab) for lab in _core.running_labs()]


class Connection(NamedTuple):
    """The bus of a lab."""

    bus: Any  #: a LockstepBus in virtual time, else a _core.LiveBus
    name: str  #: of the lab; empty: it is not known
    directory: Optional[Path]  #: of the run; None: it is not known


def connect(name: Optional[str], url: Optional[str]) -> Connection:
    """Connects to the lab that started this program, else to the named or the only one on this machine.

    Raises ConnectionError if there is none, or several."""
    if url is None and name is None and os.environ.get(LOCKSTEP):
        return _connection(LockstepBus(int(os.environ[LOCKSTEP])), "", os.environ.get("ACTIVE_LAB_DIRECTORY", ""))
    if url is None and name is None and os.environ.get("ACTIVE_LAB_URL"):
        return _connection(_core.LiveBus(os.environ["ACTIVE_LAB_URL"]), "", os.environ.get("ACTIVE_LAB_DIRECTORY", ""))
    if url is not None:
        return _connection(_core.LiveBus(url), name or "", "")
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
    return _connection(_core.LiveBus(labs[0].url), labs[0].name, labs[0].directory)


def _connection(bus: Any, name: str, directory: str) -> Connection:
    path = Path(directory) if directory else None
    return Connection(bus, name or (path.name if path else ""), path)
