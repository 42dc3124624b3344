"""Films and series of pictures as arrays."""
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy

from active_lab import Film, films
from active_lab.films import films_in
from support import main


def picture(number):
    """A ramp that moves."""
    x, y = numpy.meshgrid(numpy.arange(64), numpy.arange(48))
    return ((2 * x + 3 * y + 5 * number) % 256).astype(numpy.uint8)


def write_pictures(folder, times):
    folder.mkdir()
    for number, _ in enumerate(times):
        (folder / f"f{number:04}.pgm").write_bytes(b"P5\n64 48\n255\n" + picture(number).tobytes())
    (folder / "frames.csv").write_text("frame,t_s\n" + "".join(f"{i},{t}\n" for i, t in enumerate(times)))


def element(code, content):
    """An element of Matroska (EBML, RFC 8794)."""
    return bytes.fromhex(code) + (0x10000000 | len(content)).to_bytes(4, "big") + content


def mkv_of_size(width, height):
    """A movie of one frame that states this size, which ffprobe gives unchecked: no decoder knows it."""
    video = element("b0", width.to_bytes(4, "big")) + element("ba", height.to_bytes(4, "big"))
    track = (element("d7", b"\1") + element("73c5", b"\1") + element("83", b"\1") + element("86", b"V_XYZ")
             + element("e0", video))
    frame = element("e7", b"\0") + element("a3", b"\x81\0\0\x80abc")
    return element("1a45dfa3", element("4282", b"matroska")) + element("18538067", (
        element("1549a966", element("2ad7b1", (1_000_000).to_bytes(4, "big")))
        + element("1654ae6b", element("ae", track)) + element("1f43b675", frame)))


class Films(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="lab_python_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.times = [0, 0.5, 1.1, 1.5]
        write_pictures(cls.folder / "film", cls.times)
        cls.movie = cls.folder / "film.mkv"
        subprocess.run(["ffmpeg", "-v", "error", "-framerate", "10", "-i", cls.folder / "film" / "f%04d.pgm", "-c:v",
                        "ffv1", cls.movie], check=True)

    def assert_film(self, film, times):
        self.assertEqual((len(film), film.size), (4, (64, 48)))
        frames = list(film.frames())
        self.assertEqual(len(frames), 4)
        for number, ((t, image), expected) in enumerate(zip(frames, times)):
            self.assertAlmostEqual(t, expected, places=3)
            numpy.testing.assert_array_equal(image, picture(number))

    def test_pictures_have_the_times_of_their_table(self):
        self.assert_film(Film(self.folder / "film"), self.times)

    def test_a_movie_has_its_own_times(self):
        self.assert_film(Film(self.movie), [0, 0.1, 0.2, 0.3])

    def test_colour_is_a_third_dimension(self):
        _, image = next(Film(self.movie).frames(colour=True))
        self.assertEqual(image.shape, (48, 64, 3))

    def test_films_of_a_folder_are_found(self):
        self.assertEqual([film.path.name for film in films_in(self.folder)], ["film", "film.mkv"])

    def test_what_is_no_film_is_named(self):
        with self.assertRaises(FileNotFoundError):
            Film(self.folder / "nothing.mkv")
        wrong = self.folder / "wrong.mkv"
        wrong.write_text("no movie")
        with self.assertRaisesRegex(ValueError, "wrong.mkv"):
            list(Film(wrong).frames())
        wrong.unlink()

    def test_lists_that_name_other_files_are_refused(self):
        folder = self.folder / "lists"
        folder.mkdir()
        self.addCleanup(shutil.rmtree, folder)
        inner = folder / "inner.ts"
        subprocess.run(["ffmpeg", "-v", "error", "-i", self.movie, "-c:v", "mpeg2video", "-f", "mpegts", inner], check=True)
        for name, text in (("concat.mkv", f"ffconcat version 1.0\nfile {self.movie.name}\n"),
                           ("playlist.mkv", "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\n"
                                            f"file://{inner}\n#EXT-X-ENDLIST\n")):
            shutil.copy(self.movie, folder)
            film = folder / name
            film.write_text(text)
            for read in (lambda: Film(film).size, lambda: Film(film).times, lambda: list(Film(film).frames())):
                with self.assertRaisesRegex(ValueError, name):
                    read()

    def file(self, name, content):
        path = self.folder / name
        path.write_bytes(content)
        self.addCleanup(path.unlink)
        return path

    def test_pictures_have_at_most_200_million_pixels(self):
        film = Film(self.file("huge.mkv", mkv_of_size(60_000, 60_000)))
        for read in (lambda: film.size, lambda: next(film.frames())):
            with self.assertRaisesRegex(ValueError, "huge.mkv: found 60000 x 60000 pixels, expected at most 200 million"):
                read()
        self.assertEqual(Film(self.file("small.mkv", mkv_of_size(64, 48))).size, (64, 48))

    def ffprobe(self, script):
        """A program of this name that prints what this script does."""
        folder = Path(tempfile.mkdtemp(dir=self.folder))
        self.addCleanup(shutil.rmtree, folder)
        program = folder / "ffprobe"
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(0o700)
        return mock.patch.dict(os.environ, {"PATH": f"{folder}:{os.environ['PATH']}"})

    def test_a_movie_has_a_limited_number_of_frames(self):
        with mock.patch.object(films, "_MOST_FRAMES", 4):
            self.assertEqual(len(Film(self.movie)), 4)
        with mock.patch.object(films, "_MOST_FRAMES", 3):
            with self.assertRaisesRegex(ValueError, "film.mkv: found more than 3 frames, expected at most that many"):
                len(Film(self.movie))
        # They are counted while the list is read: this one has no end.
        with mock.patch.object(films, "_MOST_FRAMES", 100_000), self.ffprobe("yes best_effort_timestamp_time=1"):
            with self.assertRaisesRegex(ValueError, "film.mkv: found more than 100000 frames"):
                len(Film(self.movie))
        with self.ffprobe("yes"), self.assertRaisesRegex(ValueError, "film.mkv: found more than 1 MB in the answer"):
            Film(self.movie).size  # pylint: disable=pointless-statement

    def test_times_are_not_huge(self):
        def times(*seconds):
            lines = "".join(f"best_effort_timestamp_time={second}|\\n\\n" for second in seconds)
            with self.ffprobe(f"printf '{lines}'"):
                return list(Film(self.movie).times)

        self.assertEqual(times("4102444799.500000", "4102444800.000000"), [0, 0.5])
        self.assertEqual(times(-1, 950_399, 1_900_799), [0, 950_400, 1_900_800])
        for huge in ("4102444801", "9223372036854775807000000.000000", "inf", "nan"):
            with self.assertRaisesRegex(ValueError, "film.mkv: found frames at .* expected .* year 2100"):
                times(0, huge)
        with self.assertRaisesRegex(ValueError, "film.mkv: found 950401 s between two frames, expected at most 950400"):
            times(0, 950_401)
        with self.assertRaisesRegex(ValueError, "film.mkv: found a frame without a time"):
            times(0, "N/A")

    def test_names_are_shown_without_control_characters(self):
        folder = self.folder / "odd\x1b]0;x\x07\u202e"
        folder.mkdir()
        self.addCleanup(shutil.rmtree, folder)
        self.assertIn("odd\\x1b]0;x\\x07\\u202e>", repr(Film(folder)))

    def test_a_pipe_is_refused_at_once(self):
        folder = self.folder / "pipes"
        folder.mkdir()
        self.addCleanup(shutil.rmtree, folder)
        os.mkfifo(folder / "movie.mkv")
        with self.assertRaisesRegex(ValueError, "movie.mkv: found no regular file"):
            Film(folder / "movie.mkv")
        pictures = folder / "film"
        write_pictures(pictures, self.times)
        (pictures / "frames.csv").unlink()
        os.mkfifo(pictures / "frames.csv")
        os.mkfifo(pictures / "f9999.pgm")
        with self.assertRaisesRegex(ValueError, "frames.csv: found no regular file"):
            Film(pictures).times
        self.assertEqual(len(Film(pictures)), 4)
        self.assertEqual(films_in(folder), [])


if __name__ == "__main__":
    main()
