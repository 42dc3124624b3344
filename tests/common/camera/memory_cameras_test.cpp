#include "common/camera/memory_cameras.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "common/loop/virtual_loop.hpp"

namespace lab {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class MemoryCamerasTest : public testing::Test {
 protected:
  static CameraFormat format(int width = 4, int height = 3) {
    CameraFormat wanted;
    wanted.width = width;
    wanted.height = height;
    wanted.fps = 50;
    return wanted;
  }

  CameraHandlers handlers() {
    CameraHandlers all;
    all.frame = [this](const CameraFrame& frame) {
      numbers.push_back(frame.number);
      times.push_back(frame.utime);
      values.push_back(frame.grey.row(frame.grey.height - 1)[frame.grey.width - 1]);
    };
    all.trouble = [this](const std::string& text) { troubles.push_back(text); };
    return all;
  }

  void show(FrameSink& sink, int number) {
    for (std::uint8_t& pixel : sink.canvas()) pixel = static_cast<std::uint8_t>(number);
    sink.show(number, 1000 * number);
  }

  void run() { loop.runUntil(loop.now() + 1); }

  VirtualLoop loop;
  MemoryCameras dut{loop};
  std::vector<std::int64_t> numbers;
  std::vector<std::int64_t> times;
  std::vector<int> values;
  std::vector<std::string> troubles;
};

TEST_F(MemoryCamerasTest, PassesFramesAtTheSameTime) {
  const auto sink = dut.offer(format());
  const auto source = dut.open("sim", {}, handlers());

  show(*sink, 7);
  EXPECT_THAT(numbers, IsEmpty()) << "only after the painter has returned";
  run();

  EXPECT_THAT(numbers, ElementsAre(7));
  EXPECT_THAT(times, ElementsAre(7000));
  EXPECT_THAT(values, ElementsAre(7));
  EXPECT_EQ(source->format().width, 4);
  EXPECT_EQ(source->format().fps, 50);
  EXPECT_TRUE(source->format().locked);
}

TEST_F(MemoryCamerasTest, WaitsForThePainter) {
  const auto source = dut.open("sim", {}, handlers());
  EXPECT_EQ(source->format().width, 0);
  const auto sink = dut.offer(format());

  show(*sink, 0);
  run();

  EXPECT_THAT(numbers, ElementsAre(0));
  EXPECT_THAT(troubles, IsEmpty());
}

TEST_F(MemoryCamerasTest, EveryReaderGetsEveryFrame) {
  const auto sink = dut.offer(format());
  EXPECT_FALSE(sink->isWatched());
  const auto one = dut.open("sim", {}, handlers());
  auto two = dut.open("sim", {}, handlers());
  EXPECT_TRUE(sink->isWatched());

  show(*sink, 1);
  run();
  two.reset();
  show(*sink, 2);
  run();

  EXPECT_THAT(numbers, ElementsAre(1, 1, 2));
}

TEST_F(MemoryCamerasTest, CountsMissingFrames) {
  const auto sink = dut.offer(format());
  const auto source = dut.open("sim", {}, handlers());

  show(*sink, 0);
  run();
  show(*sink, 3);  // the camera lost 1 and 2
  run();
  for (int number = 4; number < 10; ++number) show(*sink, number);  // before the reader runs
  run();

  EXPECT_THAT(numbers, ElementsAre(0, 3, 6, 7, 8, 9)) << "four frames can wait";
  EXPECT_THAT(values, ElementsAre(0, 3, 6, 7, 8, 9));
  EXPECT_EQ(source->dropped(), 4);
}

TEST_F(MemoryCamerasTest, ReportsThatThePainterIsGoneAndBack) {
  auto sink = dut.offer(format());
  const auto source = dut.open("sim", {}, handlers());
  show(*sink, 9);
  run();

  sink.reset();
  run();
  sink = dut.offer(format(8, 8));
  run();
  show(*sink, 0);
  run();

  EXPECT_THAT(troubles, ElementsAre(HasSubstr("the simulated camera is gone"), ""));
  EXPECT_THAT(numbers, ElementsAre(9, 0));
  EXPECT_EQ(source->dropped(), 0);
  EXPECT_EQ(source->format().width, 8);
}

TEST_F(MemoryCamerasTest, AnotherSizeThanRequestedIsTrouble) {
  const auto sink = dut.offer(format());
  const auto source = dut.open("sim", format(8, 3), handlers());

  show(*sink, 0);
  show(*sink, 1);
  run();

  EXPECT_THAT(numbers, IsEmpty());
  EXPECT_THAT(troubles, ElementsAre(HasSubstr("paints 4 x 3 pixels, wanted are 8 x 3")));
}

TEST_F(MemoryCamerasTest, AHandlerMayCloseItsCamera) {
  const auto sink = dut.offer(format());
  std::unique_ptr<FrameSource> source;
  int count = 0;
  CameraHandlers once;
  once.frame = [&](const CameraFrame&) {
    ++count;
    source.reset();
  };
  source = dut.open("sim", {}, once);

  show(*sink, 0);
  show(*sink, 1);
  run();

  EXPECT_EQ(count, 1);
  EXPECT_FALSE(sink->isWatched());
}

TEST_F(MemoryCamerasTest, HasOnlyTheSimulatedCamera) {
  const auto sink = dut.offer(format());

  EXPECT_THROW(static_cast<void>(dut.offer(format())), CameraError);
  EXPECT_THROW(static_cast<void>(dut.open("/dev/video0", {}, handlers())), CameraError);
  MemoryCameras other(loop);
  EXPECT_THROW(static_cast<void>(other.offer(format(0, 3))), CameraError);
}

TEST(NoCameras, ThrowThatThereAreNone) {
  EXPECT_THROW(static_cast<void>(noCameras().open("sim", {}, {})), CameraError);
  EXPECT_THROW(static_cast<void>(noCameras().offer({})), CameraError);
}

}  // namespace
}  // namespace lab
