"""A run: its log as tables, its light, its results, its films."""
import json
import sys
from functools import cached_property
from pathlib import Path
from typing import Any, Dict, List, Sequence

import numpy
import pandas

from . import _core, films
from .log import Log, PathLike, label

if sys.version_info >= (3, 11):
    import tomllib
else:
    tomllib = None

LOG = "log.lcmlog"
#: Unit and meaning of the columns of trajectories.csv.
_TRAJECTORIES = {
    "frame": ("", "number of the camera frame"),
    "particle": ("", "id of the robot"),
    "x": ("cm", "midpoint between the wheels in the arena frame, as tracked"),
    "y": ("cm", "midpoint between the wheels in the arena frame, as tracked"),
    "t": ("s", "middle of the exposure, since time 0"),
    "theta": ("rad", "heading, counter-clockwise from x"),
    "program": ("", "name of the program that the robot reported, or standing"),
    "segment": ("", "number of the uninterrupted piece of free motion; -1: no free motion"),
    "state": ("", "why the row is, or is not, free motion"),
    "contact": ("", "none, robot, wall or both"),
    "light_front": ("", "reading of the front light sensor, 0 to 1; nan: none"),
    "light_back": ("", "reading of the back light sensor, 0 to 1; nan: none"),
    "x_stitched": ("cm", "place with the reversals removed; nan: not free"),
    "y_stitched": ("cm", "place with the reversals removed; nan: not free"),
}
_PICTURES = (".svg", ".png", ".jpg", ".jpeg", ".pdf")


class Run(Log):
    """A run, by its folder or its log. Times `t` are in seconds since the script of the light began, as
    in the report; lengths are in m, angles in rad.

        run = active_lab.open("runs/NAME-20260131T120000Z")
        run.poses, run.states, run.events, run.analysis, run.collective, run.truth    # tables (pandas)
        run.light.at(t, x, y), run.light.field(t).image()             # the light, anywhere
        run.table("ROBOT_STATUS", "robots", columns=["utime", "battery"])   # any message of the log
        run.experiment, run.summary, run.films, run.pictures
    """

    def __init__(self, path: PathLike) -> None:
        given = Path(path)
        if given.is_dir() and not (given / LOG).exists():
            raise FileNotFoundError(f"{given}: no {LOG} in this folder; expected the folder of a run")
        super().__init__(given / LOG if given.is_dir() else given)
        #: The folder of the run.
        self.folder: Path = self.path.parent
        self.name: str = given.resolve().name if given.is_dir() else self.path.name

    # --- time ---

    @cached_property
    def start_utime(self) -> int:
        """Time 0 [us since 1970]: the command of the first step of the light script; without a script
        the start of the experiment; without that the first camera frame."""
        if "EXPERIMENT_EVENT" in self:
            events = self.table("EXPERIMENT_EVENT", columns=["kind", "step", "utime", "commanded_utime"],
                                checked=True)
            kind = label(events, "kind")
            first = events[(kind == "STEP") & (events.step == 0)]
            if len(first):
                return int(first.commanded_utime.iloc[-1])
            if (kind == "START").any():
                return int(events.utime[kind == "START"].iloc[0])
        if "TRACKED_FRAME" in self:
            frames = self.table("TRACKED_FRAME", columns=["utime"], checked=True)
            if len(frames):
                return int(frames.utime.iloc[0])
        return min((int(entry["first_utime"]) for entry in self._channels), default=0)

    def seconds(self, utime: Any) -> Any:
        """Times in us since 1970 as seconds since time 0; of a time that is 0 ("never"), nan."""
        times = numpy.asarray(utime, dtype=numpy.int64)
        return numpy.where(times == 0, numpy.nan, (times - self.start_utime) / 1e6)[()]

    def utime(self, t: Any) -> Any:
        """The inverse of seconds()."""
        return (self.start_utime + numpy.round(numpy.asarray(t, dtype=float) * 1e6).astype(numpy.int64))[()]

    # --- tables ---

    @cached_property
    def poses(self) -> pandas.DataFrame:
        """Every robot in every camera frame, as tracked: t, frame, robot_id, x, y, theta, confidence.

        theta is the heading, counter-clockwise from x. The covariances are in
        table("TRACKED_FRAME", "robots")."""
        return self._robots("TRACKED_FRAME", "robots", ["robot_id", "x", "y", "theta", "confidence"],
                            ["frame"])

    @cached_property
    def truth(self) -> pandas.DataFrame:
        """The true poses, of a simulated run only: t, robot_id, x, y, theta (not wrapped), ..."""
        return self._robots("SIM_TRUTH", "robots",
                            ["robot_id", "x", "y", "theta", "program", "contact_robot", "contact_wall"])

    @cached_property
    def states(self) -> pandas.DataFrame:
        """What each robot reported: t of its sampling, program, wheel speeds, light, IR, flags, ...

        In an hour of many robots these are gigabytes: take the columns that you need with
        table("ROBOT_STATUS", "robots", columns=[...])."""
        states = self.table("ROBOT_STATUS", "robots", checked=True)
        attrs = states.attrs
        states.insert(0, "t", self.seconds(states.utime))
        return _described(states.drop(columns=["event", "parent", "message_utime"]), attrs)

    @cached_property
    def events(self) -> pandas.DataFrame:
        """What happened: START, STEP, FAULT, MARK, CALIBRATION, END, each once. Times of a step are in s,
        nan: it was not observed."""
        events = self.table("EXPERIMENT_EVENT", checked=True)
        attrs = events.attrs
        events.insert(0, "t", self.seconds(events.utime))
        events["kind"] = label(events, "kind")
        for column in [name for name in events.columns if name.endswith("_utime") and name != "received_utime"]:
            events[column[:-len("utime")] + "t"] = self.seconds(events.pop(column))
        # Each is sent several times, because LCM may lose messages.
        told = ["utime", "kind", "text", "step", "label", "first_acted_t", "last_acted_t", "robots_acted",
                "presented_t", "seen_t"]
        events = events.drop_duplicates(told)
        again = (events.kind == "START") & events.duplicated(["kind", "text"])  # it is repeated once a minute
        events = events[~again].drop(columns=["event", "received_utime", "sender", "instance", "seq"])
        attrs["units"].update({name: "s" for name in events.columns if name.endswith("_t")})
        return _described(events.reset_index(drop=True), attrs)

    @cached_property
    def analysis(self) -> pandas.DataFrame:
        """The estimates of the analyzer while the run went on: t, robot_id (-1: all robots together),
        program, name, value, sigma, low, high, theory, unit. The last ones are in `summary`."""
        estimates = self.table("ANALYSIS", "estimates", above=["robot_id", "program_name"], checked=True)
        return self._of_analysis(estimates)

    @cached_property
    def curves(self) -> pandas.DataFrame:
        """The curves of the analyzer: t, robot_id, program, name, lag, value, sigma, exact, paper."""
        lags = self.table("ANALYSIS", "curves.lags", checked=True,
                          above=["robot_id", "program_name", "curves.name", "curves.unit"])
        return self._of_analysis(lags)

    @cached_property
    def collective(self) -> pandas.DataFrame:
        """The observables of many robots while the run went on: t, program (empty: all robots), name, value,
        sigma, ... (docs/collective.md). The curves are in table("COLLECTIVE", "curves")."""
        return self._of_analysis(self.table("COLLECTIVE", "observables", above=["program_name"], checked=True))

    def _of_analysis(self, table: pandas.DataFrame) -> pandas.DataFrame:
        attrs = table.attrs
        table.insert(0, "t", self.seconds(table.utime))
        table = table.drop(columns=["event", "received_utime", "parent"]).rename(columns={"program_name": "program"})
        attrs["descriptions"]["program"] = "program of motion that the result is of"
        return _described(table, attrs)

    def _robots(self, channel: str, path: str, columns: Sequence[str],
                of_message: Sequence[str] = ()) -> pandas.DataFrame:
        """Columns of a list, with the time and further columns of its message."""
        robots = self.table(channel, path, columns=columns, checked=True)
        heads = self.table(channel, columns=["utime", f"num_{path}", *of_message], checked=True)
        counts = heads[f"num_{path}"].to_numpy()
        series: Dict[str, Any] = {"t": numpy.repeat(self.seconds(heads.utime), counts)}
        for name in of_message:
            series[name] = numpy.repeat(_small(heads[name].to_numpy()), counts)
        series.update({name: robots[name].array for name in columns})
        frame = pandas.DataFrame(series, index=robots.index, copy=False)
        frame.attrs = robots.attrs
        frame.attrs["units"]["t"] = "s"
        frame.attrs["descriptions"]["t"] = heads.attrs["descriptions"].get("utime", "") + ", since time 0"
        frame.attrs["start_utime"] = self.start_utime
        return frame

    # --- light ---

    @cached_property
    def light(self) -> "Light":
        """The light on the arena, over time and place."""
        return Light(self)

    # --- the other files of the run ---

    @cached_property
    def experiment(self) -> Dict[str, Any]:
        """The effective experiment file, with every default filled in; keys as in experiment files."""
        if tomllib is None:
            raise RuntimeError("experiment needs Python 3.11 or newer (tomllib)")
        text = self.experiment_text
        try:
            _core.check_toml(text)
            return tomllib.loads(text)
        except (ValueError, RecursionError) as error:
            raise ValueError(f"{self.path}: the START of the experiment is damaged: {error}; its text is in "
                             "experiment_text") from None

    @cached_property
    def experiment_text(self) -> str:
        """The same as text."""
        for _, _, message in self.messages("EXPERIMENT_EVENT"):
            if message.kind == message.START:  # type: ignore[attr-defined]
                text = str(message.text)  # type: ignore[attr-defined]
                return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
        raise KeyError(f"{self.path} has no START of an experiment")

    @cached_property
    def arena(self) -> "tuple[float, float]":
        """Width and height of the arena [m]."""
        arena = self.experiment.get("arena", {})
        try:
            return float(arena.get("width_cm", 120.0)) / 100, float(arena.get("height_cm", 90.0)) / 100
        except (AttributeError, TypeError, ValueError):
            raise ValueError(f"{self.path}: the START of the experiment is damaged: found the arena {arena!r}, "
                             "expected width_cm and height_cm") from None

    @cached_property
    def summary(self) -> Dict[str, Any]:
        """The numbers of the report (summary.json; docs/report.md has its keys)."""
        file = self.folder / "summary.json"
        self._require_report(file)
        try:
            summary = json.loads(file.read_text(encoding="utf-8"))
        except (ValueError, RecursionError) as error:
            raise ValueError(f"{file}: is no summary of a run ({error}); make it again with: "
                             f"lab analyze {self.folder}") from None
        if not isinstance(summary, dict):
            raise ValueError(f"{file}: found a {type(summary).__name__}, expected an object; make it again with: "
                             f"lab analyze {self.folder}")
        return summary

    @cached_property
    def trajectories(self) -> pandas.DataFrame:
        """trajectories.csv of the report: x, y in cm, with program and segment of every pose."""
        file = self.folder / "trajectories.csv"
        self._require_report(file)
        table = pandas.read_csv(file)
        described = {name: about for name, about in _TRAJECTORIES.items() if name in table.columns}
        table.attrs["units"] = {name: unit for name, (unit, _) in described.items() if unit}
        table.attrs["descriptions"] = {name: text for name, (_, text) in described.items()}
        return table

    def _require_report(self, file: Path) -> None:
        if not file.exists():
            raise FileNotFoundError(f"{file}: there is no report yet; make it with: lab analyze {self.folder}")
        # A run may come from a stranger. Files of the kernel look like regular ones.
        if not file.is_file() or file.resolve().parts[1:2] in (("proc",), ("sys",), ("dev",)):
            raise OSError(f"{file}: found no regular file, expected a file of the report; make it again with: "
                          f"lab analyze {self.folder}")

    @property
    def films(self) -> "List[films.Film]":
        """The films and series of pictures in the run's folder."""
        return films.films_in(self.folder)

    @property
    def pictures(self) -> List[Path]:
        """The figures of the report and the images of the light script."""
        return sorted(file for file in self.folder.rglob("*")
                      if file.suffix.lower() in _PICTURES and file.is_file())

    def __repr__(self) -> str:
        try:
            head = f"{self.experiment.get('name', '')}, seed {self.experiment.get('seed', '')}"
        except (KeyError, RuntimeError):
            head = "without START"
        except ValueError:
            head = "with a damaged START"
        described = _core.printable(f"{self.name}: {head}")
        return f"<Run {described}, {self.message_count} messages>\n{self._summary()}"


def _described(table: pandas.DataFrame, attrs: Dict[str, Any]) -> pandas.DataFrame:
    """The table with the attributes of the columns that it has; those with times `t` are in s."""
    attrs["units"]["t"] = "s"
    for name in ("units", "descriptions", "values"):
        attrs[name] = {column: value for column, value in attrs[name].items() if column in table.columns}
    table.attrs = attrs
    return table


def _small(numbers: numpy.ndarray) -> numpy.ndarray:
    """As int32 if they fit."""
    if numbers.size and numbers.dtype == numpy.int64 and abs(numbers).max() < 2**31:
        return numbers.astype(numpy.int32)
    return numbers


class Field:
    """The light at one moment."""

    def __init__(self, core: "_core.LightField", arena: "tuple[float, float]", t: float) -> None:
        self._core = core
        self._arena = arena
        #: When it was first on the arena [s].
        self.t = t
        #: Label of the step of the script.
        self.label: str = core.label

    def at(self, x: Any, y: Any) -> Any:
        """Intensity, 0 dark to 1 projector white, at places [m]: numbers or arrays of one shape."""
        xs, ys = numpy.broadcast_arrays(numpy.asarray(x, float), numpy.asarray(y, float))
        return self._core.at(xs.ravel(), ys.ravel()).reshape(xs.shape)[()]

    def sensor(self, x: float, y: float, radius: float) -> float:
        """Mean intensity over a disk, as a light sensor sees it."""
        return self._core.sensor(x, y, radius)

    def image(self, cell: float = 0.01) -> numpy.ndarray:
        """The light on the arena in square cells of `cell` [m]. Row 0 is at y = 0: draw it with
        imshow(image, origin="lower", extent=field.extent)."""
        width, height = self._arena
        x = numpy.arange(cell / 2, width, cell)
        y = numpy.arange(cell / 2, height, cell)
        return self.at(*numpy.meshgrid(x, y))

    @property
    def extent(self) -> "tuple[float, float, float, float]":
        """The arena for imshow() [m]."""
        return 0.0, self._arena[0], 0.0, self._arena[1]


class Light:
    """The light of a run, evaluated by the code of the projector and of the simulated sensors."""

    def __init__(self, run: Run) -> None:
        self._run = run
        images = run.folder / "images"
        self._history = _core.LightHistory(run.files, images if images.is_dir() else None)

    @cached_property
    def table(self) -> pandas.DataFrame:
        """LIGHT_STATUS: what was shown, since when, by whose command."""
        table = self._run.table("LIGHT_STATUS", checked=True)
        table.insert(0, "t", self._run.seconds(table.utime))
        table.attrs["units"]["t"] = "s"
        return table

    def at(self, t: Any, x: Any, y: Any) -> Any:
        """Intensity, 0 dark to 1 projector white, at times [s] and places [m]: numbers or arrays. nan
        before the first light. `light.at(poses.t, poses.x, poses.y)` is the light at every pose."""
        ts, xs, ys = numpy.broadcast_arrays(numpy.asarray(t, float), numpy.asarray(x, float),
                                            numpy.asarray(y, float))
        utimes = numpy.asarray(self._run.utime(ts.ravel()))
        return self._history.at(utimes, xs.ravel(), ys.ravel()).reshape(ts.shape)[()]

    def field(self, t: float) -> Field:
        """The light at one moment [s]."""
        core = self._history.field(int(self._run.utime(t)))
        if core is None:
            raise ValueError(f"there was no light yet at t = {t} s")
        return Field(core, self._run.arena, float(self._run.seconds(core.utime)))


def open(path: PathLike) -> Run:  # noqa: A001 (as in `with gzip.open`)
    """Opens a run by its folder, or by its log."""
    return Run(path)
