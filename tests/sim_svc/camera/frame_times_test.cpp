#include "sim_svc/camera/frame_times.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/files/experiment_error.hpp"

namespace lab::sim::frame_times_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kStart = 1'000'000;

/// The camera of a file of frames in a folder of its own.
class RecordedCamera {
 public:
  explicit RecordedCamera(const std::string& text)
      : folder_(fs::path(testing::TempDir()) / "frames") {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "frames.csv") << text;
    camera_.fps = 10;
    camera_.frames = "frames.csv";
  }
  ~RecordedCamera() { fs::remove_all(folder_); }
  RecordedCamera(const RecordedCamera&) = delete;
  RecordedCamera& operator=(const RecordedCamera&) = delete;

  [[nodiscard]] FrameTimes times() const { return {camera_, folder_}; }

 private:
  fs::path folder_;
  Camera camera_;
};

std::vector<std::int64_t> taken(FrameTimes& times, std::size_t most) {
  std::vector<std::int64_t> exposures;
  while (times.next() && exposures.size() < most) {
    exposures.push_back(*times.next());
    times.advance();
  }
  return exposures;
}

TEST(FrameTimes, AreMultiplesOfThePeriodWithoutRoundingErrors) {
  Camera camera;
  camera.fps = 30;
  FrameTimes dut(camera, {});
  dut.begin(kStart);

  EXPECT_THAT(taken(dut, 4),
              ElementsAre(kStart, kStart + 33'333, kStart + 66'667, kStart + 100'000));
  EXPECT_EQ(dut.missing(), nullptr);
  EXPECT_FALSE(dut.isRecorded());
}

TEST(FrameTimes, AreThoseOfTheRecordFromTheStartOfTheScriptOn) {
  const RecordedCamera camera("t_s,missing\n0.01,\n0.13,2 3\n0.2,\n");
  FrameTimes dut = camera.times();
  dut.begin(kStart);
  EXPECT_THAT(taken(dut, 2), ElementsAre(kStart, kStart + 100'000));

  dut.beginScript(kStart + 150'000);

  ASSERT_NE(dut.missing(), nullptr);
  EXPECT_THAT(*dut.missing(), IsEmpty());
  EXPECT_EQ(dut.next(), kStart + 160'000);
  dut.advance();
  EXPECT_THAT(*dut.missing(), ElementsAre(2, 3));
  EXPECT_THAT(taken(dut, 9), ElementsAre(kStart + 280'000, kStart + 350'000));
  EXPECT_FALSE(dut.next());
}

TEST(FrameTimes, NeverGoBack) {
  const RecordedCamera camera("t_s,missing\n0,\n0.05,\n0.15,\n");
  FrameTimes dut = camera.times();
  dut.begin(kStart);
  static_cast<void>(taken(dut, 2));

  dut.beginScript(kStart + 50'000);

  EXPECT_THAT(taken(dut, 9), ElementsAre(kStart + 200'000));
}

TEST(FrameTimes, RefuseADamagedFile) {
  for (const char* text : {"", "t,missing\n0,\n", "t_s,missing\n0.2,\n0.1,\n", "t_s,missing\n1\n",
                           "t_s,missing\n-1,\n", "t_s,missing\n1,x\n", "t_s,missing\nnan,\n"}) {
    const RecordedCamera camera(text);
    if (text[0] == '\0') {
      FrameTimes dut = camera.times();  // no frames at all
      dut.begin(kStart);
      dut.beginScript(kStart);
      EXPECT_FALSE(dut.next());
      continue;
    }
    try {
      static_cast<void>(camera.times());
      ADD_FAILURE() << text;
    } catch (const ExperimentError& error) {
      EXPECT_THAT(error.problems().front(), HasSubstr("frames.csv:")) << text;
    }
  }
}

}  // namespace
}  // namespace lab::sim::frame_times_test
