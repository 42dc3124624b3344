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

    def test_a_rotated_movie_is_read_as_stored(self):
        plain = self.folder / "plain.mp4"
        self.addCleanup(plain.unlink)
        subprocess.run(["ffmpeg", "-v", "error", "-i", self.movie, "-c:v", "png", plain], check=True)
        data = plain.read_bytes()
        track = data.index(b"tkhd")
        upright, turned = (numpy.array(matrix, ">i4").tobytes() for matrix in (
            (1 << 16, 0, 0, 0, 1 << 16, 0, 0, 0, 1 << 30), (0, 1 << 16, 0, -1 << 16, 0, 0, 48 << 16, 0, 1 << 30)))
        self.assertEqual(data.count(upright, track, track + 100), 1)
        rotated = self.file("rotated.mp4", data[:track] + data[track:].replace(upright, turned, 1))
        entries = subprocess.run(["ffprobe", "-v", "error", "-show_entries", "stream_side_data=rotation", "-of",
                                  "csv=p=0", rotated], check=True, capture_output=True, text=True).stdout
        self.assertEqual(abs(int(entries)), 90)
        self.assert_film(Film(rotated), [0, 0.1, 0.2, 0.3])

    def pictures(self, name):
        """A copy of the film, which the test may damage."""
        folder = self.folder / name
        self.addCleanup(shutil.rmtree, folder)
        write_pictures(folder, self.times)
        return folder

    def test_jpeg_pictures_are_read(self):
        folder = self.pictures("jpeg")
        for file in list(folder.glob("*.pgm")):
            subprocess.run(["ffmpeg", "-v", "error", "-i", file, "-vf", "scale=640:480:flags=neighbor", "-q:v", "1",
                            file.with_suffix(".jpg")], check=True)
            file.unlink()
        frames = list(Film(folder).frames())
        self.assertEqual([t for t, _ in frames], self.times)
        for number, (_, image) in enumerate(frames):
            self.assertLess(float(abs(image[5::10, 5::10].astype(float) - picture(number)).mean()), 10)

    def test_a_picture_that_is_not_like_the_others_is_named(self):
        cut, turned = (b"P5\n64 48\n255\n" + bytes(1000), b"P5\n48 64\n255\n" + bytes(64 * 48))
        size = "f0002.pgm: found 48 x 64 pixels, expected 64 x 48"
        for name, content, colour, text in (("cut", cut, False, "f0002.pgm: ffmpeg cannot read it"),
                                            ("turned", turned, False, size), ("turned_in_colour", turned, True, size)):
            folder = self.pictures(name)
            (folder / "f0002.pgm").write_bytes(content)
            frames = Film(folder).frames(colour)
            self.assertEqual([next(frames)[0], next(frames)[0]], self.times[:2])
            with self.subTest(name), self.assertRaisesRegex(ValueError, text):
                next(frames)

    def test_a_file_is_one_picture(self):
        folder = self.pictures("several")
        jpeg = self.folder / "one.jpg"
        self.addCleanup(jpeg.unlink)
        subprocess.run(["ffmpeg", "-v", "error", "-i", folder / "f0002.pgm", jpeg], check=True)
        (folder / "f0002.jpg").write_bytes(2 * jpeg.read_bytes())
        (folder / "f0002.pgm").unlink()
        with self.assertRaisesRegex(ValueError, "f0002.jpg: found several pictures, expected one"):
            list(Film(folder).frames())

    def test_a_movie_that_breaks_off_is_named(self):
        one = "printf 'P5\\n64 48\\n255\\n'; head -c 3072 /dev/zero; "
        with self.program("ffmpeg", one + one + "echo first >&2; printf 'at 0.2 s\\033[2J\\n' >&2; exit 69"):
            frames = Film(self.movie).frames()
            self.assertEqual([round(next(frames)[0], 3) for _ in range(2)], [0, 0.1])
            with self.assertRaisesRegex(ValueError, r"film.mkv: ffmpeg cannot read it: first; at 0.2 s\\x1b\[2J$"):
                next(frames)
            frames = Film(self.movie).frames()
            next(frames)
            frames.close()  # who stops early is not told
        with self.program("ffmpeg", one + "echo header damaged >&2"):
            with self.assertWarnsRegex(UserWarning, "film.mkv: ffmpeg: header damaged"):
                self.assertEqual(len(list(Film(self.movie).frames())), 1)

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
        return self.program("ffprobe", script)

    def program(self, name, script):
        """A program of this name that prints what this script does."""
        folder = Path(tempfile.mkdtemp(dir=self.folder))
        self.addCleanup(shutil.rmtree, folder)
        program = folder / name
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
