"""Films and series of pictures as arrays. Movies need the programs ffmpeg and ffprobe."""
import csv
import json
import math
import re
import shutil
import subprocess
import threading
import warnings
from array import array
from contextlib import contextmanager
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import IO, Iterator, List, Optional, Tuple

import numpy

from . import _core

# As tracker_svc/cameras/movie_reader.cpp: no playlists (hls, dash, concat, imf, sdp), which name other files.
_FORMATS = ("matroska,webm,mov,mp4,avi,mpegts,mpeg,mpegvideo,flv,live_flv,asf,ogg,nut,mxf,gxf,rm,wtv,dv,dirac,"
            "ivf,obu,av1,h261,h263,h264,hevc,m4v,vc1,avs2,cavsvideo,dnxhd,mjpeg,mjpeg_2000,smjpeg,mlv,vidc,"
            "yuv4mpegpipe,ser,gif,apng,fits,bmp_pipe,dpx_pipe,exr_pipe,gif_pipe,j2k_pipe,jpeg_pipe,"
            "jpegls_pipe,jpegxl_pipe,pam_pipe,pbm_pipe,pgm_pipe,png_pipe,ppm_pipe,qoi_pipe,sgi_pipe,"
            "sunrast_pipe,tiff_pipe,webp_pipe,tty")
_JPEG = (".jpg", ".jpeg")

# As picture_size.hpp and packet_times.hpp there. A movie of 300 bytes can state any size, and one of 200 kB can
# have 200 000 frames.
_MOST_PIXELS = 200_000_000
_MOST_FRAMES = 20_000_000
_LATEST_S = 4_102_444_800.0  # the year 2100
_LONGEST_GAP_S = 11 * 86_400.0
_MOST_ANSWER = 1_000_000  # of ffprobe, and of one line of it [characters]

MOVIES = (".mkv", ".mp4", ".avi", ".mov")
PICTURES = (".pgm", ".png", *_JPEG, ".bmp")


class Film:
    """A movie, or a folder of pictures with their times in frames.csv.

        film = run.films[0]
        for t, picture in film.frames():        # uint8, height x width
            ...
    """

    def __init__(self, path: Path) -> None:
        self.path = Path(path)
        if not self.path.exists():
            raise FileNotFoundError(f"{self.path}: no such movie or folder of pictures")
        if not self.path.is_dir():
            _require_file(self.path)

    @property
    def _files(self) -> List[Path]:
        files = [file for file in self.path.iterdir() if file.suffix.lower() in PICTURES and file.is_file()]
        return sorted(files, key=lambda file: (_number(file), file.name))

    @cached_property
    def times(self) -> Optional[numpy.ndarray]:
        """Times of the frames since the first [s]; None: pictures without frames.csv."""
        if self.path.is_dir():
            table = self.path / "frames.csv"
            if not table.exists():
                return None
            _require_file(table)
            with open(table, encoding="utf-8-sig", newline="") as rows:
                known = {int(row["frame"]): float(row["t_s"]) for row in csv.DictReader(rows)}
            return numpy.array([known[_number(file)] for file in self._files])
        return _movie_times(self.path)

    @cached_property
    def size(self) -> Tuple[int, int]:
        """Width and height [px]."""
        source = self._files[0] if self.path.is_dir() else self.path
        entries = json.loads(_output("ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries",
                                     "stream=width,height", "-of", "json", *_input(source)))
        width, height = int(entries["streams"][0]["width"]), int(entries["streams"][0]["height"])
        if width * height > _MOST_PIXELS:
            raise ValueError(f"{source}: found {width} x {height} pixels, expected at most 200 million: make it "
                             "smaller with ffmpeg (-vf scale=W:H)")
        return width, height

    def __len__(self) -> int:
        if self.path.is_dir():
            return len(self._files)
        times = self.times
        return 0 if times is None else len(times)

    def frames(self, colour: bool = False) -> Iterator[Tuple[Optional[float], numpy.ndarray]]:
        """(time since the first frame [s], picture) one after the other; the time is None if it is not
        known. Pictures are uint8 of height x width, with colour of height x width x 3, as stored: not
        rotated."""
        times = self.times
        pictures = self._decoded(colour)
        for number, picture in enumerate(pictures):
            yield (float(times[number]) if times is not None and number < len(times) else None), picture

    def _decoded(self, colour: bool) -> Iterator[numpy.ndarray]:
        if not self.path.is_dir():
            yield from self._pipe(self.path, colour)
            return
        for file in self._files:  # one left out would give all later ones wrong times
            pictures = list(islice(self._pipe(file, colour), 2))
            if len(pictures) != 1:
                raise ValueError(f"{file}: found {'several pictures' if pictures else 'no whole picture'}, expected "
                                 "one: remove the file to read the others")
            yield pictures[0]

    def _pipe(self, source: Path, colour: bool) -> Iterator[numpy.ndarray]:
        width, height = self.size
        shape = (height, width, 3) if colour else (height, width)
        # In PGM and PPM each picture says its size.
        code, pixels = ("ppm", "rgb24") if colour else ("pgm", "gray")
        head = f"{'P6' if colour else 'P5'}\n{width} {height}\n255\n".encode()
        with _running("ffmpeg", "-v", "error", "-nostdin", "-noautorotate", *_input(source), "-map", "0:v:0",
                      "-fps_mode", "passthrough", "-f", "image2pipe", "-c:v", code, "-pix_fmt", pixels,
                      "-") as (output, errors):
            while found := b"".join(output.readline(32) for _ in range(3)):
                if found != head:
                    size = " x ".join(found.decode("ascii", "replace").split()[1:3])
                    raise ValueError(f"{source}: found {size} pixels, expected {width} x {height} in the whole film: "
                                     "scale it with ffmpeg (-vf scale=W:H)")
                data = output.read(math.prod(shape))
                if len(data) < math.prod(shape):
                    break
                yield numpy.frombuffer(data, numpy.uint8).reshape(shape)
        if errors:
            warnings.warn(f"{source}: ffmpeg: {errors[-1]}")

    def __repr__(self) -> str:
        return f"<Film {_core.printable(str(self.path))}>"


def films_in(folder: Path) -> List[Film]:
    """The movies below a folder, and its folders of pictures with frames.csv."""
    found = [file for file in folder.rglob("*") if file.suffix.lower() in MOVIES and file.is_file()]
    found += [table.parent for table in folder.rglob("frames.csv") if table.is_file()]
    return [Film(path) for path in sorted(set(found))]


def _input(file: Path) -> List[str]:
    """A file, for ffmpeg and ffprobe. They would take the name of a JPEG for a pattern of names."""
    form = ["-f", "jpeg_pipe"] if file.suffix.lower() in _JPEG else []
    return [*form, "-protocol_whitelist", "file", "-format_whitelist", _FORMATS, "-i", f"file:{file}"]


def _require_file(file: Path) -> None:
    """Reading a pipe would wait for ever."""
    if not file.is_file():
        raise ValueError(f"{file}: found no regular file, expected one; make a copy of its content")


def _number(file: Path) -> int:
    """The last number in a file's name, as the lab counts pictures; -1: there is none."""
    numbers = re.findall(r"\d+", file.stem)
    return int(numbers[-1]) if numbers else -1


def _program(name: str) -> str:
    path = shutil.which(name)
    if path is None:
        raise FileNotFoundError(f"{name} is not installed: sudo apt-get install ffmpeg")
    return path


def _movie_times(movie: Path) -> numpy.ndarray:
    times = array("d")
    key = "best_effort_timestamp_time="
    for line in _lines("ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries",
                       "frame=best_effort_timestamp_time", "-of", "compact=p=0", *_input(movie)):
        if not line.startswith(key):
            continue  # an empty line of side data
        if len(times) == _MOST_FRAMES:
            raise ValueError(f"{movie}: found more than {_MOST_FRAMES} frames, expected at most that many: cut it with "
                             "ffmpeg (-ss, -t)")
        time = line[len(key):].partition("|")[0]
        if time == "N/A":
            raise ValueError(f"{movie}: found a frame without a time, expected one for each: convert it to MKV with "
                             "ffmpeg")
        times.append(float(time))
    if not times:
        return numpy.array([])
    seconds = numpy.frombuffer(times)
    first, last = seconds.min(), seconds.max()
    if not (first >= -_LONGEST_GAP_S and last <= _LATEST_S):
        raise ValueError(f"{movie}: found frames at {first:g} s to {last:g} s, expected {-_LONGEST_GAP_S:g} s to "
                         f"{_LATEST_S:g} s (the year 2100): give them other times with ffmpeg (-r RATE -i FILE)")
    gap = numpy.diff(seconds).max(initial=0)
    if gap > _LONGEST_GAP_S:
        raise ValueError(f"{movie}: found {gap:g} s between two frames, expected at most {_LONGEST_GAP_S:g} s "
                         "(11 days): give them other times with ffmpeg (-r RATE -i FILE)")
    return seconds - seconds[0]


@contextmanager
def _running(program: str, *arguments: str) -> Iterator[Tuple[IO[bytes], List[str]]]:
    """What a program prints, read while it runs, and (after the block) the last lines of its errors.

    Raises ValueError with the last ones if the program fails. A reader that leaves the block ends it."""
    errors: List[str] = []

    def keep_the_end(pipe: IO[bytes]) -> None:
        end = b""
        while piece := pipe.read(4096):
            end = (end + piece)[-4096:]
        errors.extend(_core.printable(line) for line in end.decode("utf-8", "replace").splitlines() if line.strip())

    command = [_program(program), *arguments]
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stderr is not None
        reader = threading.Thread(target=keep_the_end, args=(process.stderr,), daemon=True)
        reader.start()
        try:
            yield process.stdout, errors
            process.wait()
        finally:
            process.kill()
            process.stdout.close()
            reader.join()
    if process.returncode != 0:
        source = arguments[arguments.index("-i") + 1].removeprefix("file:")
        raise ValueError(f"{source}: {program} cannot read it: {'; '.join(errors[-2:]) or 'it gives no reason'}")


def _lines(program: str, *arguments: str) -> Iterator[str]:
    """What a program prints, line by line while it runs: its input may be of any length."""
    with _running(program, *arguments) as (output, _):
        while line := output.readline(_MOST_ANSWER):
            yield line.decode("utf-8", "replace").rstrip("\r\n")


def _output(program: str, *arguments: str) -> str:
    output = ""
    for line in _lines(program, *arguments):
        output += line + "\n"
        if len(output) > _MOST_ANSWER:
            raise ValueError(f"{arguments[-1]}: found more than 1 MB in the answer of {program}, expected less: is the "
                             "file damaged?")
    return output
