// Times in the table of a film, which may come from a stranger.
#include "common/camera/run_film.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "common/bus/value_checker.hpp"
#include "common/files/experiment_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::run_film_test {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kBegin = 946'684'800'000'000;

/// What readFilmTable() says of two frames.
std::string problemOf(const FilmFrame& first, FilmFrame second) {
  const TemporaryFolder folder;
  const auto file = folder / "film.frames.csv";
  second.frame = 1;
  std::ofstream(file) << filmTableHeader(FilmTable::kOneCamera)
                      << filmTableLine(first, FilmTable::kOneCamera)
                      << filmTableLine(second, FilmTable::kOneCamera);
  try {
    EXPECT_EQ(readFilmTable(file).size(), 2U);
  } catch (const CameraError& error) {
    return error.what();
  }
  return "none";
}

FilmFrame at(std::int64_t camera_utime, std::int64_t arrived_utime) {
  return {.camera_utime = camera_utime, .arrived_utime = arrived_utime};
}

TEST(FilmTableTimes, AreThoseOfMicrosecondsSince1970) {
  const FilmFrame first = at(0, kBegin);

  EXPECT_EQ(problemOf(first, at(50'000, kBegin + 50'000)), "none");
  EXPECT_THAT(problemOf(first, at(9'000'000'000'000'000'000, kBegin)),
              HasSubstr("film.frames.csv:3: camera_utime: found 9000000000000000000, expected 0 to "
                        "4102444800000000: the table is damaged; without it"));
  EXPECT_THAT(problemOf(first, at(50'000, 9'000'000'000'000'000'000)),
              HasSubstr("film.frames.csv:3: arrived_utime: found 9000000000000000000, expected 0"));
  EXPECT_THAT(problemOf(at(-1, kBegin), first),
              HasSubstr("film.frames.csv:2: camera_utime: found -1, expected 0 to"));
  EXPECT_THAT(problemOf(at(0, -1), first),
              HasSubstr("film.frames.csv:2: arrived_utime: found -1, expected 0 to"));
}

TEST(FilmTableTimes, OfTheCameraIncrease) {
  for (const std::int64_t utime : {kBegin, kBegin - 1, std::int64_t{0}}) {
    EXPECT_THAT(problemOf(at(kBegin, kBegin), at(utime, kBegin)),
                HasSubstr("film.frames.csv:3: camera_utime: found " + std::to_string(utime) +
                          " after 946684800000000, expected times that increase"));
  }
}

/// A virtual loop runs through all the time between arrivals.
TEST(FilmTableTimes, OfArrivalLieWithinTheLongestRun) {
  const FilmFrame first = at(kBegin, kBegin);

  EXPECT_EQ(problemOf(first, at(kBegin + 1, kBegin + kLongestFilm_us)), "none");
  EXPECT_THAT(problemOf(first, at(kBegin + 1, kBegin + kLongestFilm_us + 1)),
              HasSubstr("film.frames.csv:3: arrived_utime: found 947635200000001, expected at most "
                        "11 days after the first, 946684800000000"));
  // A clock was set back.
  EXPECT_EQ(problemOf(first, at(kBegin + 1, kBegin - 60'000'000)), "none");
}

TEST(FilmFactsTimes, EndInTheYear2100) {
  const TemporaryFolder folder;
  FilmFacts facts;
  facts.format.width = facts.format.height = 100;
  facts.start_utime = ValueChecker::kLatestUtime + 1'000'000'000'000;
  ASSERT_TRUE(writeFilmFacts(folder / "film.json", facts));

  EXPECT_THAT([&] { static_cast<void>(readFilmFacts(folder / "film.json")); },
              testing::ThrowsMessage<ExperimentError>(HasSubstr("start_utime: found 4.10344e+15")));
}

}  // namespace
}  // namespace lab::run_film_test
