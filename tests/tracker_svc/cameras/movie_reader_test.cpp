// Movies with the table of their frames, and what ffmpeg may read. Both may come from a stranger.
#include "tracker_svc/cameras/movie_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "common/camera/run_film.hpp"
#include "tests/support/film_samples.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"
#include "tests/tracker_svc/cameras/hand_made_movies.hpp"
#include "tracker_svc/cameras/packet_times.hpp"

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

/// What openMovie() says of a file with this content.
std::string refusalOf(const std::string& content, double fps = 0) {
  const TemporaryFolder folder;
  support::writeFile(folder / "a.film", content);
  try {
    static_cast<void>(openMovie((folder / "a.film").string(), fps));
  } catch (const CameraError& error) {
    return error.what();
  }
  return "none";
}

// A file of 250 bytes: its pictures need no data, and ffprobe gives their size unchecked.
TEST(MovieSize, IsAtMost200MillionPixels) {
  if (!hasFfmpeg()) GTEST_SKIP() << "ffmpeg is not installed: movies are not tested";

  EXPECT_THAT(refusalOf(mkvOfSize(60'000, 60'000)),
              HasSubstr("a.film: found 60000 x 60000 pixels, expected at most 200 million"));
  EXPECT_THAT(refusalOf(mkvOfSize(20'000, 10'001)), HasSubstr("found 20000 x 10001 pixels"));
  EXPECT_THAT(refusalOf(mkvOfSize(64, 48)), "none");
}

TEST(MovieTimes, AreNotHuge) {
  if (!hasFfmpeg()) GTEST_SKIP() << "ffmpeg is not installed: movies are not tested";
  const std::string month = mp4OfSamples({{4, 40}, {1, 2'000'000'000}, {5, 40}});

  EXPECT_THAT(refusalOf(month), HasSubstr("a.film: found 2e+06 s between two frames, expected at "
                                          "most 950400 s (11 days): give the rate"));
  EXPECT_THAT(refusalOf(month, 25), "none");
  EXPECT_THAT(refusalOf(mp4OfSamples({{4, 40}, {1, 900'000'000}, {5, 40}})), "none");
}

TEST(MoviePackets, AreOfALimitedNumber) {
  if (!hasFfmpeg()) GTEST_SKIP() << "ffmpeg is not installed: movies are not tested";
  const TemporaryFolder folder;
  const std::string movie = folder / "a.mp4";
  support::writeFile(movie, mp4OfSamples({{12, 40}}));

  EXPECT_EQ(probeMovie(movie, 12).utimes.size(), 12U);
  EXPECT_EQ(probeMovie(movie, 0).utimes.size(), 0U);
  EXPECT_THAT([&] { static_cast<void>(probeMovie(movie, 11)); },
              testing::ThrowsMessage<CameraError>(
                  HasSubstr("a.mp4: found more than 11 frames, expected at most that many")));
}

/// The memory that this process has had at most [kB].
std::int64_t peakMemory() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return used.ru_maxrss;
}

// A file of 200 kB. With a tree of its packets, 225 MB of memory were needed.
TEST(MoviePackets, NeedOneNumberEach) {
  if (!hasFfmpeg()) GTEST_SKIP() << "ffmpeg is not installed: movies are not tested";
  const TemporaryFolder folder;
  const std::string movie = folder / "a.mp4";
  support::writeFile(movie, mp4OfSamples({{200'000, 1}}));
  // In a process of its own: its peak is not that of earlier tests.
  const auto measure = [&movie] {
    const std::int64_t before = peakMemory();
    const std::size_t frames = probeMovie(movie, kMostPackets).utimes.size();
    const std::int64_t needed = peakMemory() - before;
    std::fprintf(stderr, "%zu frames, %lld kB\n", frames, static_cast<long long>(needed));
    std::_Exit(frames == 200'000 && needed < 50'000 ? 0 : 1);
  };

  EXPECT_EXIT(measure(), testing::ExitedWithCode(0), "");
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
