// The simulated camera between processes: any order of starting, killed processes, slow and several
// readers.
#include "common/camera/shared_camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "common/camera/frame_ring.hpp"
#include "common/camera/shared_cameras.hpp"
#include "tests/support/loop_until.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

CameraFormat sized(int width, int height) {
  CameraFormat format;
  format.width = width;
  format.height = height;
  format.fps = 100;
  return format;
}

/// Checks that all pixels have the same value, which detects a mixture of two frames.
void show(FrameSink& sink, std::int64_t number) {
  std::ranges::fill(sink.canvas(), static_cast<std::uint8_t>(number));
  sink.show(number, 10 * number);
}

bool isWhole(const CameraFrame& frame) {
  const auto wanted = static_cast<std::uint8_t>(frame.number);
  for (int y = 0; y < frame.grey.height; ++y) {
    const std::uint8_t* row = frame.grey.row(y);
    if (std::any_of(row, row + frame.grey.width, [=](auto value) { return value != wanted; })) {
      return false;
    }
  }
  return true;
}

/// A process that paints a frame every millisecond while there is a reader.
class PainterProcess {
 public:
  PainterProcess(const std::filesystem::path& folder, const CameraFormat& format) {
    pid_ = fork();
    if (pid_ != 0) return;
    AsioLoop loop;
    SharedCameras cameras(loop, folder);
    const auto sink = cameras.offer(format);
    std::int64_t number = 0;
    loop.every(1000, loop.now(), [&] {
      if (sink->isWatched()) show(*sink, number++);
    });
    loop.run();
    _exit(0);
  }
  ~PainterProcess() { kill(); }
  PainterProcess(const PainterProcess&) = delete;
  PainterProcess& operator=(const PainterProcess&) = delete;

  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }

 private:
  pid_t pid_;
};

class SharedCamera : public testing::Test {
 protected:
  CameraHandlers handlers() {
    CameraHandlers all;
    all.frame = [this](const CameraFrame& frame) {
      if (!isWhole(frame)) ++torn;
      numbers.push_back(frame.number);
      times.push_back(frame.utime);
    };
    all.trouble = [this](const std::string& text) { troubles.push_back(text); };
    return all;
  }

  [[nodiscard]] std::function<bool()> frames(std::size_t count) {
    return [this, wanted = numbers.size() + count] { return numbers.size() >= wanted; };
  }
  [[nodiscard]] std::function<bool()> complaints(std::size_t count) {
    return [this, count] { return troubles.size() >= count; };
  }

  TemporaryFolder folder;
  AsioLoop loop;
  SharedCameras dut{loop, folder / "lab"};
  std::vector<std::int64_t> numbers;
  std::vector<std::int64_t> times;
  std::vector<std::string> troubles;
  int torn = 0;
};

TEST_F(SharedCamera, PassesFrames) {
  const auto sink = dut.offer(sized(64, 48));
  const auto source = dut.open("sim", sized(64, 48), handlers());
  ASSERT_TRUE(loopUntil(loop, [&] { return sink->isWatched(); }));

  show(*sink, 5);
  show(*sink, 7);

  ASSERT_TRUE(loopUntil(loop, frames(2)));
  EXPECT_THAT(numbers, ElementsAre(5, 7));
  EXPECT_THAT(times, ElementsAre(50, 70));
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(source->dropped(), 1);
  EXPECT_EQ(source->format().width, 64);
  EXPECT_EQ(source->format().height, 48);
  EXPECT_EQ(source->format().fps, 100);
  EXPECT_TRUE(source->format().locked);
  EXPECT_FALSE(std::filesystem::exists(folder / "lab")) << "the camera uses no file";
}

TEST_F(SharedCamera, IsFoundInAnotherProcessThatStartsLater) {
  const auto source = dut.open("sim", {}, handlers());
  PainterProcess painter(folder / "lab", sized(320, 200));

  ASSERT_TRUE(loopUntil(loop, frames(50)));

  EXPECT_EQ(torn, 0);
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
}

TEST_F(SharedCamera, IsFoundAgainAfterItsProcessWasKilled) {
  const auto source = dut.open("sim", {}, handlers());
  auto painter = std::make_unique<PainterProcess>(folder / "lab", sized(320, 200));
  ASSERT_TRUE(loopUntil(loop, frames(20)));

  painter->kill();
  ASSERT_TRUE(loopUntil(loop, complaints(1)));
  painter = std::make_unique<PainterProcess>(folder / "lab", sized(160, 100));
  ASSERT_TRUE(loopUntil(loop, frames(20)));

  EXPECT_THAT(troubles, ElementsAre(HasSubstr("the simulated camera is gone"), ""));
  EXPECT_EQ(source->format().width, 160);
  EXPECT_EQ(torn, 0);
}

TEST_F(SharedCamera, ThePainterKnowsWhetherThereAreReaders) {
  const auto sink = dut.offer(sized(8, 8));
  EXPECT_FALSE(sink->isWatched());
  for (int round = 0; round < 3; ++round) {
    auto source = dut.open("sim", {}, handlers());
    ASSERT_TRUE(loopUntil(loop, [&] { return sink->isWatched(); }));
    show(*sink, round);
    ASSERT_TRUE(loopUntil(loop, frames(1)));
    source.reset();
    ASSERT_TRUE(loopUntil(loop, [&] { return !sink->isWatched(); }));
  }
  EXPECT_THAT(numbers, ElementsAre(0, 1, 2));
}

TEST_F(SharedCamera, ASlowReaderLosesFramesButGetsNoMixedOnes) {
  std::atomic<bool> reading = false;
  std::atomic<bool> go_on = true;
  std::thread painter([&] {
    AsioLoop painters;
    SharedCameras cameras(painters, folder / "lab");
    const auto sink = cameras.offer(sized(320, 200));
    std::int64_t number = 0;
    painters.every(1000, painters.now(), [&] {
      // Paints many frames, also while the reader is in its handler.
      for (int i = 0; i < 30 && sink->isWatched(); ++i) show(*sink, number++);
      if (!go_on) painters.stop();
    });
    painters.run();
  });
  CameraHandlers slow = handlers();
  slow.frame = [&](const CameraFrame& frame) {
    numbers.push_back(frame.number);
    for (int look = 0; look < 200; ++look) torn += isWhole(frame) ? 0 : 1;
  };
  auto source = dut.open("sim", {}, slow);

  const bool came = loopUntil(loop, frames(50));
  const std::int64_t dropped = source->dropped();
  go_on = false;
  painter.join();

  ASSERT_TRUE(came);
  EXPECT_EQ(torn, 0);
  EXPECT_GT(dropped, 0);
  EXPECT_EQ(dropped, numbers.back() - numbers.front() + 1 - std::ssize(numbers));
}

TEST_F(SharedCamera, HasRoomForSixReaders) {
  const auto sink = dut.offer(sized(8, 8));
  std::vector<std::unique_ptr<FrameSource>> sources;
  for (std::size_t i = 0; i < cameras::kRingReaders; ++i) {
    sources.push_back(dut.open("sim", {}, handlers()));
    ASSERT_TRUE(loopUntil(loop, [&] { return sources.back()->format().width == 8; }));
  }
  show(*sink, 1);
  ASSERT_TRUE(loopUntil(loop, frames(6)));

  const auto seventh = dut.open("sim", {}, handlers());

  ASSERT_TRUE(loopUntil(loop, complaints(1)));
  EXPECT_THAT(troubles, ElementsAre(HasSubstr("6 programs read it already")));
  sources.pop_back();
  ASSERT_TRUE(loopUntil(loop, complaints(2)));
  EXPECT_EQ(troubles.back(), "") << "a reader has left";
}

TEST_F(SharedCamera, OneLabHasOneCamera) {
  const auto sink = dut.offer(sized(8, 8));
  SharedCameras same(loop, folder / "lab");
  SharedCameras other(loop, folder / "other");

  EXPECT_NO_THROW(static_cast<void>(other.offer(sized(8, 8))));
  try {
    static_cast<void>(same.offer(sized(8, 8)));
    FAIL();
  } catch (const CameraError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is offered already; end the other sim_svc"));
  }
}

TEST_F(SharedCamera, AnotherSizeThanRequestedIsTrouble) {
  const auto sink = dut.offer(sized(8, 8));
  const auto source = dut.open("sim", sized(16, 8), handlers());

  ASSERT_TRUE(loopUntil(loop, complaints(1)));

  EXPECT_THAT(troubles, ElementsAre(HasSubstr("paints 8 x 8 pixels, wanted are 16 x 8")));
  EXPECT_THAT(numbers, IsEmpty());
}

TEST_F(SharedCamera, AHandlerMayCloseItsCamera) {
  const auto sink = dut.offer(sized(8, 8));
  std::unique_ptr<FrameSource> source;
  CameraHandlers once = handlers();
  once.frame = [&](const CameraFrame& frame) {
    numbers.push_back(frame.number);
    source.reset();
  };
  source = dut.open("sim", {}, once);
  ASSERT_TRUE(loopUntil(loop, [&] { return sink->isWatched(); }));

  show(*sink, 0);
  show(*sink, 1);

  ASSERT_TRUE(loopUntil(loop, [&] { return !sink->isWatched(); }));
  EXPECT_THAT(numbers, ElementsAre(0));
}

TEST(FrameRing, AHeldFrameIsNotOverwritten) {
  using namespace cameras;
  RingWriter writer(sized(16, 16));
  RingReader reader(FileDescriptor(dup(writer.descriptor())), 0);
  std::ranges::fill(writer.canvas(), std::uint8_t{42});
  const RingNotice first = writer.publish(0, 0);
  const std::uint8_t* pixels = reader.hold(first);
  ASSERT_NE(pixels, nullptr);

  for (int i = 0; i < 100; ++i) {
    std::ranges::fill(writer.canvas(), std::uint8_t{7});
    EXPECT_NE(writer.publish(i, 0).slot, first.slot);
  }

  EXPECT_EQ(pixels[255], 42);
  reader.release();
  for (std::size_t i = 0; i < kRingSlots; ++i) {
    std::ranges::fill(writer.canvas(), std::uint8_t{7});
    static_cast<void>(writer.publish(0, 0));
  }
  EXPECT_EQ(reader.hold(first), nullptr) << "after its release it is overwritten";
}

TEST(FrameRing, RefusesOtherMemory) {
  FileDescriptor other(memfd_create("other", 0));
  ASSERT_EQ(ftruncate(other.get(), 1 << 16), 0);

  EXPECT_THROW(cameras::RingReader(other, 0), CameraError);
}

}  // namespace
}  // namespace lab
