// The frames of a film that a clip shows. The folder of the run may come from a stranger.
#include "runner/film/clip_films.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/film_samples.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner::clip_films_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::int64_t kBegin = 946'684'800'000'000;
constexpr std::int64_t kPeriod_us = 100'000;

class ClipFilms : public testing::Test {
 protected:
  void SetUp() override {
    if (!hasFfmpeg()) GTEST_SKIP() << "ffmpeg is not installed: films are not tested";
    fs::create_directory(scratch_);
  }

  /// A film of six frames, of which every second one is shown.
  [[nodiscard]] ClipFilm film(const std::string& name) const {
    ClipFilm made;
    made.movie = folder_ / name;
    made.facts.first_utime = kBegin;
    made.facts.format.fps = 10;
    made.stride = 2;
    for (int i = 0; i < 6; ++i) {
      FilmFrame& frame = made.table.emplace_back();
      frame.frame = i;
      frame.camera_utime = i * kPeriod_us;
    }
    return made;
  }

  std::string problem(const std::string& name) {
    const ClipFilm of = film(name);
    try {
      FilmPlayer(of, 0, scratch_);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "none";
  }

  TemporaryFolder folder_;
  fs::path scratch_ = folder_ / "scratch";
};

TEST_F(ClipFilms, ShowTheFramesOfTheirStride) {
  writeMovie(folder_ / "film.mkv", 6, "-c:v ffv1 -g 1 -pix_fmt gray");
  const ClipFilm of = film("film.mkv");
  FilmPlayer dut(of, 0, scratch_);

  dut.play(kBegin + 3 * kPeriod_us);

  EXPECT_EQ(dut.at(kBegin + 3 * kPeriod_us), kBegin + 2 * kPeriod_us);
  EXPECT_TRUE(isPictureOf(dut.picture(), 2));
}

TEST_F(ClipFilms, AreRegularFiles) {
  ASSERT_EQ(mkfifo((folder_ / "film.mkv").c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", folder_ / "device.mkv");

  EXPECT_THAT(problem("film.mkv"), HasSubstr("film.mkv: found a pipe, expected a movie"));
  EXPECT_THAT(problem("device.mkv"), HasSubstr("device.mkv: found a device, expected a movie"));
}

TEST_F(ClipFilms, AreNoListsOfOtherFiles) {
  writeMovie(folder_ / "other.mkv", 6, "-c:v ffv1 -g 1 -pix_fmt gray");
  std::ofstream(folder_ / "film.mkv") << "ffconcat version 1.0\nfile other.mkv\n";
  std::ofstream(folder_ / "hls.mkv")
      << "#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:10,\nother.mkv\n#EXT-X-ENDLIST\n";

  EXPECT_THAT(problem("film.mkv"), HasSubstr("film.mkv: ffmpeg cannot copy its frames"));
  EXPECT_THAT(problem("hls.mkv"), HasSubstr("hls.mkv: ffmpeg cannot copy its frames"));
}

}  // namespace
}  // namespace lab::runner::clip_films_test
