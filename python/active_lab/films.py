"""Films and series of pictures as arrays. Movies need the programs ffmpeg and ffprobe."""
import csv
import json
import re
import shutil
import subprocess
from functools import cached_property
from pathlib import Path
from typing import Iterator, List, Optional, Tuple

import numpy

# As tracker_svc/cameras/movie_reader.cpp: no playlists (hls, dash, concat, imf, sdp), which name other files.
_FORMATS = ("matroska,webm,mov,mp4,avi,mpegts,mpeg,mpegvideo,flv,live_flv,asf,ogg,nut,mxf,gxf,rm,wtv,dv,dirac,"
            "ivf,obu,av1,h261,h263,h264,hevc,m4v,vc1,avs2,cavsvideo,dnxhd,mjpeg,mjpeg_2000,smjpeg,mlv,vidc,"
            "yuv4mpegpipe,ser,gif,apng,fits,bmp_pipe,dpx_pipe,exr_pipe,gif_pipe,j2k_pipe,jpeg_pipe,"
            "jpegls_pipe,jpegxl_pipe,pam_pipe,pbm_pipe,pgm_pipe,png_pipe,ppm_pipe,qoi_pipe,sgi_pipe,"
            "sunrast_pipe,tiff_pipe,webp_pipe,tty")
_INPUT = ("-protocol_whitelist", "file", "-format_whitelist", _FORMATS, "-i")

MOVIES = (".mkv", ".mp4", ".avi", ".mov")
PICTURES = (".pgm", ".png", ".jpg", ".jpeg", ".bmp")


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
        entries = json.loads(_output("ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries",
                                     "frame=best_effort_timestamp_time", "-of", "json", *_INPUT, f"file:{self.path}"))
        times = numpy.array([float(frame["best_effort_timestamp_time"]) for frame in entries["frames"]])
        return times - times[0] if len(times) else times

    @cached_property
    def size(self) -> Tuple[int, int]:
        """Width and height [px]."""
        source = self._files[0] if self.path.is_dir() else self.path
        entries = json.loads(_output("ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries",
                                     "stream=width,height", "-of", "json", *_INPUT, f"file:{source}"))
        return int(entries["streams"][0]["width"]), int(entries["streams"][0]["height"])

    def __len__(self) -> int:
        if self.path.is_dir():
            return len(self._files)
        times = self.times
        return 0 if times is None else len(times)

    def frames(self, colour: bool = False) -> Iterator[Tuple[Optional[float], numpy.ndarray]]:
        """(time since the first frame [s], picture) one after the other; the time is None if it is not
        known. Pictures are uint8 of height x width, with colour of height x width x 3."""
        times = self.times
        pictures = self._decoded(colour)
        for number, picture in enumerate(pictures):
            yield (float(times[number]) if times is not None and number < len(times) else None), picture

    def _decoded(self, colour: bool) -> Iterator[numpy.ndarray]:
        if self.path.is_dir():
            for file in self._files:
                yield from self._pipe([file], colour)
        else:
            yield from self._pipe([self.path], colour)

    def _pipe(self, source: List[Path], colour: bool) -> Iterator[numpy.ndarray]:
        width, height = self.size
        depth = 3 if colour else 1
        command = [_program("ffmpeg"), "-v", "error", "-nostdin", *_INPUT, f"file:{source[0]}", "-fps_mode",
                   "passthrough", "-f", "rawvideo", "-pix_fmt", "rgb24" if colour else "gray", "-"]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            try:
                while True:
                    data = process.stdout.read(width * height * depth)
                    if len(data) < width * height * depth:
                        return
                    picture = numpy.frombuffer(data, numpy.uint8)
                    yield picture.reshape((height, width, 3) if colour else (height, width))
            finally:
                process.kill()
                process.stdout.close()

    def __repr__(self) -> str:
        return f"<Film {self.path}>"


def films_in(folder: Path) -> List[Film]:
    """The movies below a folder, and its folders of pictures with frames.csv."""
    found = [file for file in folder.rglob("*") if file.suffix.lower() in MOVIES and file.is_file()]
    found += [table.parent for table in folder.rglob("frames.csv") if table.is_file()]
    return [Film(path) for path in sorted(set(found))]


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


def _output(program: str, *arguments: str) -> str:
    done = subprocess.run([_program(program), *arguments], capture_output=True, text=True)
    if done.returncode != 0:
        raise ValueError(f"{arguments[-1]}: {done.stderr.strip() or 'cannot be read'}")
    return done.stdout
