// Uses a scripted video device; no hardware is involved.
#include "tracker_svc/cameras/v4l2_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/support/loop_until.hpp"
#include "tests/tracker_svc/cameras/scripted_camera.hpp"

namespace lab {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint32_t kStartStamp =
    V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
constexpr std::uint32_t kEndStamp =
    V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;

class VideoDevice : public testing::Test {
 protected:
  VideoDevice() {
    camera.formats = {{V4L2_PIX_FMT_YUYV, 2, {{64, 48, {30}}, {128, 96, {10}}}},
                      {V4L2_PIX_FMT_MJPEG, 1, {{64, 48, {30}}, {128, 96, {30}}}},
                      {V4L2_PIX_FMT_GREY, 1, {{64, 48, {60}}}}};
    camera.controls = {{V4L2_CID_EXPOSURE_AUTO, {0, 3, V4L2_EXPOSURE_APERTURE_PRIORITY}},
                       {V4L2_CID_EXPOSURE_AUTO_PRIORITY, {0, 1, 1}},
                       {V4L2_CID_EXPOSURE_ABSOLUTE, {1, 300, 157}},
                       {V4L2_CID_GAIN, {2, 50, 20}},
                       {V4L2_CID_AUTO_WHITE_BALANCE, {0, 1, 1}},
                       {V4L2_CID_FOCUS_AUTO, {0, 1, 1}}};
  }

  static CameraFormat wanted(int width, int height, double fps) {
    CameraFormat format;
    format.width = width;
    format.height = height;
    format.fps = fps;
    format.exposure = 0.010;
    format.gain = 4;
    return format;
  }

  std::unique_ptr<FrameSource> open(const CameraFormat& format) {
    CameraHandlers handlers;
    handlers.frame = [this](const CameraFrame& frame) {
      numbers.push_back(frame.number);
      ages.push_back(loop.now() - frame.utime);
      values.push_back(frame.grey.row(frame.grey.height - 1)[frame.grey.width - 1]);
    };
    handlers.trouble = [this](const std::string& text) { troubles.push_back(text); };
    return cameras::openVideoDevice(loop, camera, "/dev/video0", format, handlers);
  }

  std::string refusal(const CameraFormat& format) {
    try {
      static_cast<void>(open(format));
    } catch (const CameraError& error) {
      return error.what();
    }
    return "opened";
  }

  [[nodiscard]] bool gets(std::size_t frames) {
    return loopUntil(loop, [&] { return numbers.size() >= frames; });
  }
  [[nodiscard]] bool hears(std::size_t texts) {
    return loopUntil(loop, [&] { return troubles.size() >= texts; });
  }

  ScriptedCamera camera;
  AsioLoop loop;
  std::vector<std::int64_t> numbers;
  std::vector<std::int64_t> ages;
  std::vector<int> values;
  std::vector<std::string> troubles;
};

TEST_F(VideoDevice, SelectsTheLeastProcessedFormat) {
  EXPECT_EQ(open(wanted(64, 48, 30))->format().pixels, "GREY");
  EXPECT_FALSE(open(wanted(64, 48, 30))->format().compressed);
  EXPECT_EQ(open(wanted(128, 96, 10))->format().pixels, "YUYV");
}

TEST_F(VideoDevice, SelectsACompressedFormatOnlyForItsRate) {
  const auto source = open(wanted(128, 96, 30));

  EXPECT_EQ(source->format().pixels, "MJPG");
  EXPECT_TRUE(source->format().compressed);
  EXPECT_EQ(source->format().fps, 30);
  EXPECT_EQ(source->format().width, 128);
}

TEST_F(VideoDevice, SelectsTheFastestIfNoneIsFastEnough) {
  EXPECT_EQ(open(wanted(64, 48, 200))->format().pixels, "GREY");
  EXPECT_EQ(open(wanted(128, 96, 200))->format().pixels, "MJPG");
}

TEST_F(VideoDevice, SwitchesOffAutomaticControls) {
  const auto source = open(wanted(64, 48, 30));

  EXPECT_EQ(camera.controls[V4L2_CID_EXPOSURE_AUTO].value, V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(camera.controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY].value, 0);
  EXPECT_EQ(camera.controls[V4L2_CID_AUTO_WHITE_BALANCE].value, 0);
  EXPECT_EQ(camera.controls[V4L2_CID_FOCUS_AUTO].value, 0);
  EXPECT_EQ(camera.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value, 100) << "10 ms in units of 100 us";
  EXPECT_EQ(camera.controls[V4L2_CID_GAIN].value, 4);
  EXPECT_TRUE(source->format().locked);
  EXPECT_DOUBLE_EQ(source->format().exposure, 0.010);
  EXPECT_EQ(source->format().gain, 4);
}

TEST_F(VideoDevice, ReportsControlsThatCannotBeLocked) {
  camera.controls[V4L2_CID_AUTO_WHITE_BALANCE].stuck = true;

  EXPECT_FALSE(open(wanted(64, 48, 30))->format().locked);
}

TEST_F(VideoDevice, ReportsTheValuesTheDeviceAccepted) {
  CameraFormat format = wanted(64, 48, 30);
  format.exposure = 0.2;
  format.gain = 1;

  const auto source = open(format);

  EXPECT_DOUBLE_EQ(source->format().exposure, 0.030);
  EXPECT_EQ(source->format().gain, 2);
}

TEST_F(VideoDevice, FramesHaveTheTimeOfTheMiddleOfTheirExposure) {
  const auto source = open(wanted(64, 48, 30));
  camera.expose(0, 10, kStartStamp, camera.clock - 25'000);
  camera.expose(1, 20, kEndStamp, camera.clock - 25'000);

  ASSERT_TRUE(gets(2));

  // Exposure 10 ms; the handler's clock may have advanced slightly.
  EXPECT_GE(ages[0], 20'000);
  EXPECT_GE(ages[1], 30'000);
  EXPECT_GE(ages[1] - ages[0], 10'000 - 5'000);
  EXPECT_THAT(values, ElementsAre(10, 20));
}

TEST_F(VideoDevice, ImplausibleTimeStampsAreIgnored) {
  const auto source = open(wanted(64, 48, 30));
  camera.expose(0, 1, kStartStamp, camera.clock + 40'000'000);  // in the future
  camera.expose(1, 2, kStartStamp, 0);                          // five seconds old
  camera.expose(2, 3, V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN, 12);

  ASSERT_TRUE(gets(3));

  for (const std::int64_t age : ages) {
    EXPECT_GE(age, 5'000) << "just come, and exposed before";
    EXPECT_LT(age, 4'000'000);
  }
}

TEST_F(VideoDevice, CountsTheFramesThatTheDriverDropped) {
  const auto source = open(wanted(64, 48, 30));
  camera.expose(4, 1);
  camera.expose(5, 2);
  camera.expose(8, 3);

  ASSERT_TRUE(gets(3));

  EXPECT_THAT(numbers, ElementsAre(0, 1, 4));
  EXPECT_EQ(source->dropped(), 2);
}

TEST_F(VideoDevice, ContinuesCountingIfTheDriverDoesNot) {
  const auto source = open(wanted(64, 48, 30));
  camera.expose(0, 1);
  camera.expose(0, 2);
  ASSERT_TRUE(gets(2));
  camera.expose(0xffffffff, 3);  // decreasing
  camera.expose(0, 4);           // and wrapped around

  ASSERT_TRUE(gets(4));

  EXPECT_THAT(numbers, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(source->dropped(), 0);
}

TEST_F(VideoDevice, DamagedFramesCountAsMissing) {
  const auto source = open(wanted(64, 48, 30));
  camera.expose(0, 1);
  camera.expose(1, 2, kStartStamp | V4L2_BUF_FLAG_ERROR);
  camera.expose(2, 3, kStartStamp, -1, 7);  // seven bytes too few
  camera.expose(3, 4);

  ASSERT_TRUE(gets(2));

  EXPECT_THAT(values, ElementsAre(1, 4));
  EXPECT_EQ(source->dropped(), 2);
}

TEST_F(VideoDevice, BuffersAreReused) {
  const auto source = open(wanted(64, 48, 30));
  for (std::uint32_t i = 0; i < 40; ++i) {
    camera.expose(i, static_cast<std::uint8_t>(i));
    ASSERT_TRUE(gets(i + 1));
  }
  EXPECT_EQ(source->dropped(), 0);
}

TEST_F(VideoDevice, LumaOfLimitedRangeIsExpanded) {
  camera.quantization = V4L2_QUANTIZATION_DEFAULT;
  const auto source = open(wanted(128, 96, 10));
  camera.expose(0, 16);
  camera.expose(1, 235);
  camera.expose(2, 5);

  ASSERT_TRUE(gets(3));

  EXPECT_THAT(values, ElementsAre(0, 255, 0));
}

TEST_F(VideoDevice, IsReopenedAfterBeingUnplugged) {
  const auto source = open(wanted(64, 48, 30));
  camera.expose(0, 1);
  ASSERT_TRUE(gets(1));

  camera.unplug();
  ASSERT_TRUE(hears(1));
  EXPECT_EQ(camera.mapped, 0);
  EXPECT_EQ(camera.opened, camera.closed);
  EXPECT_EQ(source->format().width, 0);
  camera.plugIn();
  ASSERT_TRUE(loopUntil(loop, [&] { return camera.opened == 2; }));
  camera.expose(0, 9);
  ASSERT_TRUE(gets(2));

  EXPECT_THAT(troubles, ElementsAre(HasSubstr("/dev/video0: the camera is gone"), ""));
  EXPECT_THAT(values, ElementsAre(1, 9));
  EXPECT_THAT(numbers, ElementsAre(0, 1));
  EXPECT_EQ(camera.controls[V4L2_CID_EXPOSURE_AUTO].value, V4L2_EXPOSURE_MANUAL);
}

TEST_F(VideoDevice, ReportsThatItIsInUseWhenItComesBack) {
  const auto source = open(wanted(64, 48, 30));
  camera.unplug();
  ASSERT_TRUE(hears(1));

  camera.plugIn();
  camera.open_error = EACCES;

  ASSERT_TRUE(hears(2));
  EXPECT_THAT(troubles.back(), HasSubstr("no permission"));
}

TEST_F(VideoDevice, AFewFailedFramesDoNotCountAsUnplugging) {
  const auto source = open(wanted(64, 48, 30));
  camera.failFrames(3);
  ASSERT_TRUE(loopUntil(loop, [&] {
    camera.expose(0, 1);
    return !numbers.empty();
  }));
  EXPECT_THAT(troubles, IsEmpty());

  camera.failFrames(1000);
  ASSERT_TRUE(hears(1));
  EXPECT_THAT(troubles.front(), HasSubstr("the camera is gone"));
}

TEST_F(VideoDevice, MayBeClosedByAHandler) {
  std::unique_ptr<FrameSource> source;
  int frames = 0;
  CameraHandlers handlers;
  handlers.frame = [&](const CameraFrame& frame) {
    ++frames;
    source.reset();
    EXPECT_EQ(frame.grey.row(0)[0], 1) << "the frame is there until the call returns";
  };
  source = cameras::openVideoDevice(loop, camera, "v4l2:/dev/video0", wanted(64, 48, 30), handlers);
  camera.expose(0, 1);
  camera.expose(1, 2);

  ASSERT_TRUE(loopUntil(loop, [&] { return camera.closed == 1; }));

  EXPECT_EQ(frames, 1);
  EXPECT_EQ(camera.mapped, 0);
  EXPECT_FALSE(camera.streaming);
}

TEST_F(VideoDevice, TheErrorForAMissingSizeListsTheAvailableOnes) {
  EXPECT_THAT(refusal(wanted(1280, 720, 30)),
              AllOf(HasSubstr("/dev/video0: has no 1280 x 720 pixels; it offers "
                              "YUYV 64 x 48 at 30 /s, YUYV 128 x 96 at 10 /s"),
                    HasSubstr("MJPG 128 x 96 at 30 /s"), HasSubstr("GREY 64 x 48 at 60 /s")));
  EXPECT_EQ(camera.opened, camera.closed);
}

TEST_F(VideoDevice, ADriverThatSetsAnotherSizeIsRejected) {
  camera.keeps_its_size = true;

  EXPECT_THAT(refusal(wanted(64, 48, 30)),
              HasSubstr("gave GREY 640 x 480 instead of GREY 64 x 48"));
}

TEST_F(VideoDevice, ErrorsContainAdvice) {
  const CameraFormat usual = wanted(64, 48, 30);
  camera.open_error = EACCES;
  EXPECT_THAT(refusal(usual), EndsWith("sudo usermod -aG video $USER"));
  camera.open_error = ENOENT;
  EXPECT_THAT(refusal(usual), HasSubstr("no camera there; plug it in"));
  camera.open_error = 0;
  camera.format_error = EBUSY;
  EXPECT_THAT(refusal(usual), HasSubstr("in use by another program; end that"));
  camera.format_error = 0;
  camera.stream_error = ENOSPC;
  EXPECT_THAT(refusal(usual), HasSubstr("its USB bus lacks the bandwidth"));
  camera.stream_error = 0;
  camera.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  EXPECT_THAT(refusal(usual), HasSubstr("delivers no pictures (Scripted Camera"));
  camera.capabilities = V4L2_CAP_VIDEO_CAPTURE;
  EXPECT_THAT(refusal(usual), HasSubstr("cannot stream"));
  camera.capabilities = 0;
  EXPECT_THAT(refusal(usual), EndsWith("is no camera"));
  EXPECT_EQ(camera.opened, camera.closed);
  EXPECT_EQ(camera.mapped, 0);
}

TEST(SystemVideoDevices, ThatAreNotCamerasAreRejected) {
  AsioLoop loop;
  const auto refusal = [&](const char* path) -> std::string {
    try {
      static_cast<void>(cameras::openVideoDevice(loop, cameras::systemV4l2Calls(), path, {}, {}));
    } catch (const CameraError& error) {
      return error.what();
    }
    return "opened";
  };
  EXPECT_THAT(refusal("/dev/null"), EndsWith("/dev/null: is no camera"));
  EXPECT_THAT(refusal("/dev/video-none"), HasSubstr("no camera there"));
}

}  // namespace
}  // namespace lab
