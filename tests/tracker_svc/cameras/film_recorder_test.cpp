#include "tracker_svc/cameras/film_recorder.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"
#include "tests/support/wait_until.hpp"
#include "tracker_svc/cameras/run_filmer.hpp"
#include "tracker_svc/film_reader.hpp"

namespace lab::cameras {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kWide = 64;
constexpr int kHigh = 48;
constexpr std::int64_t kBegin = 946'684'800'000'000;

/// Pictures that differ in every pixel.
optics::GreyImage picture(int number) {
  optics::GreyImage image(kWide, kHigh);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<std::uint8_t>(i * 7 + static_cast<std::size_t>(number) * 31);
  }
  return image;
}

/// Irregular times, of which milliseconds would be a rounding.
std::int64_t utimeOf(int number) { return kBegin + number * 16'667 + number % 3 * 137; }

class FilmRecorderTest : public testing::Test {
 protected:
  ~FilmRecorderTest() override { setenv("PATH", path_.c_str(), 1); }

  [[nodiscard]] FilmRecording recording(FilmCodec codec, bool may_wait = true) const {
    FilmRecording made;
    made.folder = folder_.path();
    made.film.codec = codec;
    made.format.width = kWide;
    made.format.height = kHigh;
    made.format.fps = 60;
    made.start_utime = kBegin;
    made.may_wait = may_wait;
    return made;
  }

  static void add(FilmRecorder& dut, int number) {
    dut.add(
        {.number = number, .camera_utime = utimeOf(number), .arrived_utime = utimeOf(number) + 5},
        utimeOf(number), picture(number).view());
  }

  /// Replaces ffmpeg by a shell script.
  void replaceFfmpeg(const std::string& script) {
    const fs::path program = folder_.path() / "bin" / "ffmpeg";
    fs::create_directory(program.parent_path());
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(program, fs::perms::owner_all);
    setenv("PATH", (program.parent_path().string() + ":" + path_).c_str(), 1);
  }

  [[nodiscard]] FilmFacts facts() const {
    return readFilmFacts(folder_.path() / film_files::kFacts);
  }

  [[nodiscard]] fs::path movie() const { return folder_.path() / film_files::kMovie; }

  TemporaryFolder folder_;
  std::string path_ = std::getenv("PATH");
};

class LosslessFilm : public FilmRecorderTest, public testing::WithParamInterface<FilmCodec> {};

TEST_P(LosslessFilm, HasThePixelsAndTheExactTimesOfEveryFrame) {
  {
    FilmRecorder dut(recording(GetParam()));
    for (int i = 0; i < 40; ++i) add(dut, i);
  }

  const auto film = FilmReader::open(movie().string());
  EXPECT_EQ(film->length(), 40);
  EXPECT_FALSE(film->format().compressed);
  EXPECT_EQ(film->table(), "film.frames.csv");
  CameraFrame frame;
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(film->next(frame)) << i;
    EXPECT_EQ(frame.utime, utimeOf(i) - kBegin);
    for (int y = 0; y < kHigh; ++y) {
      ASSERT_TRUE(std::equal(frame.grey.row(y), frame.grey.row(y) + kWide, picture(i).row(y))) << i;
    }
  }
  EXPECT_FALSE(film->next(frame));
  EXPECT_EQ(film->problem(), "");
  EXPECT_EQ(facts().frames, 40);
  EXPECT_EQ(facts().lost, 0);
  EXPECT_TRUE(facts().complete);
  EXPECT_EQ(facts().last_utime, utimeOf(39));
}

INSTANTIATE_TEST_SUITE_P(Codecs, LosslessFilm,
                         testing::Values(FilmCodec::kFfv1, FilmCodec::kFfvhuff));

TEST_F(FilmRecorderTest, WritesTimesIntoTheMovieItselfToo) {
  {
    FilmRecorder dut(recording(FilmCodec::kFfv1));
    for (int i = 0; i < 10; ++i) add(dut, i);
  }
  fs::remove(filmTableOf(movie()));

  const auto film = FilmReader::open(movie().string());
  CameraFrame frame;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(film->next(frame));
    EXPECT_NEAR(static_cast<double>(frame.utime), static_cast<double>(utimeOf(i) - kBegin), 1000);
  }
}

TEST_F(FilmRecorderTest, WritesH264ThatIsMarkedAsCompressed) {
  {
    FilmRecorder dut(recording(FilmCodec::kH264));
    for (int i = 0; i < 40; ++i) add(dut, i);
  }

  const auto film = FilmReader::open(movie().string());
  EXPECT_TRUE(film->format().compressed);
  CameraFrame frame;
  int frames = 0;
  while (film->next(frame)) EXPECT_EQ(frame.utime, utimeOf(frames++) - kBegin);
  EXPECT_EQ(frames, 40);
  EXPECT_EQ(facts().crf, 18);
  EXPECT_FALSE(facts().lossless());
}

TEST_F(FilmRecorderTest, CountsFramesThatAnEncoderThatHangsLosesAndEndsIt) {
  replaceFfmpeg("exec tail -f /dev/null");
  constexpr std::size_t kMany = FilmRecorder::kQueueBytes / (kWide * kHigh) + 1000;
  std::string news;
  {
    FilmRecorder dut(recording(FilmCodec::kFfv1, false));
    for (std::size_t i = 0; i < kMany; ++i) add(dut, static_cast<int>(i));
    news = dut.news();
    EXPECT_EQ(dut.news(), "");
    EXPECT_GT(dut.facts().lost, 0);
  }

  EXPECT_THAT(news, AllOf(HasSubstr("frames are lost"), HasSubstr("record_threads")));
  EXPECT_EQ(facts().frames + facts().lost + facts().after_end, static_cast<std::int64_t>(kMany));
  EXPECT_TRUE(facts().complete);
}

TEST_F(FilmRecorderTest, SaysWhyAnEncoderEnded) {
  replaceFfmpeg(
      "head -c 10000 > /dev/null; echo 'file:film.mkv: No space left on device' >&2; exit 1");
  std::string news;
  {
    FilmRecorder dut(recording(FilmCodec::kFfv1));
    for (int i = 0; i < 2000; ++i) add(dut, i);
    EXPECT_TRUE(waitUntil([&] { return !(news = dut.news()).empty(); }, std::chrono::minutes(1)));
  }

  EXPECT_THAT(news, AllOf(HasSubstr("film: ends after"), HasSubstr("No space left on device"),
                          HasSubstr("the run goes on")));
  EXPECT_THAT(facts().problem, HasSubstr("No space left"));
  EXPECT_EQ(facts().frames + facts().after_end, 2000);
}

TEST_F(FilmRecorderTest, EndsAtItsBound) {
  FilmRecording small = recording(FilmCodec::kFfv1);
  small.film.most_GB = 0.001;
  {
    FilmRecorder dut(small);
    for (int i = 0; i < 3000; ++i) add(dut, i);
  }

  EXPECT_THAT(facts().problem, HasSubstr("it has reached 0.001 GB (camera.record_most_GB)"));
  EXPECT_GT(facts().after_end, 0);
  EXPECT_EQ(facts().frames + facts().after_end, 3000);
  EXPECT_EQ(FilmReader::open(movie().string())->length(), facts().frames);
}

TEST_F(FilmRecorderTest, SaysThatFfmpegIsNotInstalled) {
  setenv("PATH", folder_.path().c_str(), 1);
  {
    FilmRecorder dut(recording(FilmCodec::kFfv1));
    for (int i = 0; i < 10; ++i) add(dut, i);
  }

  EXPECT_THAT(facts().problem,
              HasSubstr("ffmpeg, which is not installed: sudo apt install ffmpeg"));
  EXPECT_EQ(facts().after_end, 10);
}

TEST_F(FilmRecorderTest, RefusesAFolderThatDoesNotExist) {
  FilmRecording nowhere = recording(FilmCodec::kFfv1);
  nowhere.folder /= "missing";
  EXPECT_THROW(FilmRecorder{nowhere}, CameraError);
}

/// A film whose frames arrived at these times.
std::vector<FilmFrame> arrivedAt(const std::vector<std::int64_t>& times) {
  std::vector<FilmFrame> table;
  for (const std::int64_t time : times) {
    FilmFrame& frame = table.emplace_back();
    frame.frame = static_cast<std::int64_t>(table.size()) - 1;
    frame.arrived_utime = kBegin + time;
  }
  return table;
}

using Tables = std::vector<std::vector<FilmFrame>>;

TEST(OrderOfArrival, IsThatOfTimeAndInOneInstantThatOfTheCameras) {
  const Tables tables{arrivedAt({10, 20, 40}), arrivedAt({5, 20, 21}), arrivedAt({20})};
  EXPECT_THAT(orderOfArrival(tables), testing::ElementsAre(1, 0, 0, 1, 2, 1, 0));
}

TEST(OrderOfArrival, GoesOnWithTheOthersAfterTheEndOfAFilm) {
  const Tables tables{arrivedAt({}), arrivedAt({1}), arrivedAt({0, 2, 3, 4})};
  EXPECT_THAT(orderOfArrival(tables), testing::ElementsAre(2, 1, 2, 2, 2));
  EXPECT_THAT(orderOfArrival({}), testing::IsEmpty());
}

TEST(OrderOfArrival, KeepsThatOfEachFilmWhenAClockWasSetBack) {
  const Tables tables{arrivedAt({10, 4, 6}), arrivedAt({11, 5})};
  EXPECT_THAT(orderOfArrival(tables), testing::ElementsAre(0, 0, 0, 1, 1));
}

class SeveralFilms : public FilmRecorderTest {
 protected:
  static void addTo(RunFilmer& dut, std::size_t camera, int number) {
    CameraFormat format;
    format.fps = 60;
    dut.add({.number = number, .camera_utime = utimeOf(number), .arrived_utime = utimeOf(number)},
            utimeOf(number), picture(number).view(), format, camera);
  }

  [[nodiscard]] FilmFacts factsOf(const std::string& film) const {
    return readFilmFacts(folder_.path() / film / film_files::kFacts);
  }

  FilmSpec spec_;
};

TEST_F(SeveralFilms, LieInFoldersOfTheirCamerasForEachStart) {
  for (int start = 0; start < 2; ++start) {
    RunFilmer dut(folder_.path(), spec_, kBegin, true, {"right", "left"});
    for (int i = 0; i < 5; ++i) addTo(dut, 0, i);
    for (int i = 0; i < 3; ++i) addTo(dut, 1, i);
    EXPECT_EQ(dut.news(), "");
  }

  EXPECT_EQ(factsOf("film/left").frames, 3);
  EXPECT_EQ(factsOf("film/left").camera, "left");
  EXPECT_EQ(factsOf("film_2/right").frames, 5);
  const fs::path& run = folder_.path();
  EXPECT_THAT(
      filmStarts(run),
      testing::ElementsAre(testing::ElementsAre(run / "film/left", run / "film/right"),
                           testing::ElementsAre(run / "film_2/left", run / "film_2/right")));
  EXPECT_EQ(filmFolders(run).size(), 4U);
}

TEST_F(SeveralFilms, CostEachOtherNothing) {
  std::string news;
  {
    RunFilmer dut(folder_.path(), spec_, kBegin, true, {"left", "right"});
    addTo(dut, 0, 0);
    std::ofstream(folder_.path() / "film/right") << "in the way";
    for (int i = 1; i < 5; ++i) {
      addTo(dut, 0, i);
      addTo(dut, 1, i);
    }
    news = dut.news();
    EXPECT_EQ(dut.news(), "");
  }

  EXPECT_THAT(news, AllOf(HasSubstr("film of camera right: there is none: "),
                          HasSubstr("the run goes on")));
  EXPECT_EQ(factsOf("film/left").frames, 5);
  EXPECT_EQ(factsOf("film/left").problem, "");
}

TEST_F(SeveralFilms, EndAtTheBoundOfAllTogether) {
  constexpr int kFrames = 6000;
  spec_.most_GB = 0.004;
  {
    RunFilmer dut(folder_.path(), spec_, kBegin, true, {"left", "right"});
    for (int i = 0; i < kFrames; ++i) {
      addTo(dut, 0, i);
      addTo(dut, 1, i);
    }
  }

  std::int64_t bytes = 0;
  for (const char* film : {"film/left", "film/right"}) {
    const FilmFacts facts = factsOf(film);
    EXPECT_THAT(facts.problem, HasSubstr("the films of all cameras have reached 0.004 GB"));
    EXPECT_EQ(facts.frames + facts.after_end, kFrames);
    EXPECT_LT(facts.bytes, 4'000'000);  // its own bound
    bytes += facts.bytes;
  }
  EXPECT_GE(bytes, 4'000'000);
}

TEST(FilmTable, LeavesOutALineThatIsCutOff) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "film.frames.csv";
  FilmFrame frame{.frame = 0,
                  .time = 0,
                  .number = 7,
                  .camera_utime = kBegin,
                  .arrived_utime = kBegin + 20,
                  .searched = true,
                  .status_instance = 3,
                  .status_seq = 4};
  std::string text =
      filmTableHeader(FilmTable::kOneCamera) + filmTableLine(frame, FilmTable::kOneCamera);
  frame.frame = 1;
  text += filmTableLine(frame, FilmTable::kOneCamera);
  std::ofstream(file) << text.substr(0, text.size() - 5);

  const std::vector<FilmFrame> frames = readFilmTable(file);

  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].number, 7);
  EXPECT_TRUE(frames[0].searched);
  EXPECT_EQ(frames[0].status_seq, 4);
}

TEST(FilmTable, OfSeveralCamerasHasThoseThatWereLost) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "film.frames.csv";
  FilmFrame frame{.frame = 0, .number = 7, .status_seq = 4, .lost_cameras = 5};
  std::ofstream(file) << filmTableHeader(FilmTable::kSeveralCameras)
                      << filmTableLine(frame, FilmTable::kSeveralCameras) << "1,0,0,0,0,0,0,0\n";

  try {
    static_cast<void>(readFilmTable(file));
    FAIL();
  } catch (const CameraError& error) {
    EXPECT_THAT(error.what(), HasSubstr(":3: found \"1,0,0,0,0,0,0,0\", expected frame 1 and 8"));
  }
  std::ofstream(file) << filmTableHeader(FilmTable::kSeveralCameras)
                      << filmTableLine(frame, FilmTable::kSeveralCameras);
  const std::vector<FilmFrame> frames = readFilmTable(file);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].number, 7);
  EXPECT_EQ(frames[0].status_seq, 4);
  EXPECT_EQ(frames[0].lost_cameras, 5U);
}

TEST(FilmTable, NamesTheLineThatIsDamaged) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "film.frames.csv";
  std::ofstream(file) << filmTableHeader(FilmTable::kOneCamera) << "0,0,zero,0,0,0,0,0\n";

  try {
    static_cast<void>(readFilmTable(file));
    FAIL();
  } catch (const CameraError& error) {
    EXPECT_THAT(error.what(), HasSubstr("film.frames.csv:2: found \"0,0,zero"));
  }
}

TEST(FilmFactsFile, ComesBackAsItWasWritten) {
  const TemporaryFolder folder;
  FilmFacts facts;
  facts.camera = "left";
  facts.codec = "h264";
  facts.crf = 23;
  facts.format = {1920, 1080, 60, 0.005, 2, "GREY", true, false, ""};
  facts.start_utime = kBegin;
  facts.first_utime = kBegin + 1;
  facts.last_utime = kBegin + 2'000'001;
  facts.frames = 120;
  facts.lost = 3;
  facts.after_end = 2;
  facts.bytes = 123'456'789'012;
  facts.cpu = 12.5;
  facts.complete = true;
  facts.problem = "the disk";
  ASSERT_TRUE(writeFilmFacts(folder.path() / "film.json", facts));

  const FilmFacts read = readFilmFacts(folder.path() / "film.json");

  EXPECT_EQ(read.camera, "left");
  EXPECT_EQ(read.codec, "h264");
  EXPECT_EQ(read.format.fps, 60);
  EXPECT_EQ(read.format.pixels, "GREY");
  EXPECT_TRUE(read.format.locked);
  EXPECT_EQ(read.bytes, 123'456'789'012);
  EXPECT_EQ(read.lost, 3);
  EXPECT_EQ(read.duration(), 2);
  EXPECT_EQ(read.problem, "the disk");
}

}  // namespace
}  // namespace lab::cameras
