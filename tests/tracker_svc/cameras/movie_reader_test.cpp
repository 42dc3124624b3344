// Movies with the table of their frames, and what ffmpeg may read. Both may come from a stranger.
#include "tracker_svc/cameras/movie_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/camera/run_film.hpp"
#include "tests/support/film_samples.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::cameras::movie_reader_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// What openMovie() says of a movie whose camera gave these times.
std::string problemOf(const std::vector<std::int64_t>& utimes) {
  const TemporaryFolder folder;
  const fs::path movie = folder / "a.mkv";
  writeMovie(movie, static_cast<int>(utimes.size()), "-c:v ffv1 -pix_fmt gray");
  std::string table = filmTableHeader(FilmTable::kOneCamera);
  std::int64_t number = 0;
  for (const std::int64_t utime : utimes) {
    FilmFrame frame;
    frame.frame = frame.number = number++;
    frame.camera_utime = utime;
    table += filmTableLine(frame, FilmTable::kOneCamera);
  }
  support::writeFile(filmTableOf(movie), table);
  try {
    static_cast<void>(openMovie(movie.string(), 0));
  } catch (const CameraError& error) {
    return error.what();
  }
  return "none";
}

// The poses of lab track have these times.
TEST(MovieTable, HasTimesThatIncrease) {
  if (!hasFfmpeg()) GTEST_SKIP() << "ffmpeg is not installed: movies are not tested";

  EXPECT_EQ(problemOf({1'000'000, 2'000'000, 3'000'000}), "none");
  EXPECT_THAT(problemOf({1'000'000, 2'000'000, 1'500'000}),
              HasSubstr("a.frames.csv:4: camera_utime: found 1500000 after 2000000, expected"));
  EXPECT_THAT(problemOf({1'000'000, 9'000'000'000'000'000'000}),
              HasSubstr("a.frames.csv:3: camera_utime: found 9000000000000000000, expected 0 to"));
}

TEST(MovieInput, IsARegularFile) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe.mkv").c_str(), 0600), 0);
  support::writeFile(folder / "a.mkv", "whatever");

  EXPECT_THAT([&] { static_cast<void>(movieInput(folder / "pipe.mkv")); },
              testing::ThrowsMessage<CameraError>(HasSubstr("pipe.mkv: found a pipe, expected")));
  const std::vector<std::string> words = movieInput(folder / "a.mkv");
  EXPECT_EQ(words.back(), "file:" + (folder / "a.mkv").string());
  EXPECT_THAT(words, testing::Contains("-protocol_whitelist"));
  EXPECT_THAT(words, testing::Contains("-format_whitelist"));
}

}  // namespace
}  // namespace lab::cameras::movie_reader_test
