"""Films and series of pictures as arrays."""
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy

from active_lab import Film
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
