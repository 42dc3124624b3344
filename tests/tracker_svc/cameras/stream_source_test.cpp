// Network cameras and pipelines, with scripts in place of ffmpeg, ffprobe and gst-launch-1.0.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/loop_until.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tracker_svc/camera_devices.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class Streams : public testing::Test {
 protected:
  Streams() { setenv("PATH", ((folder / "").string() + ":" + old_path).c_str(), 1); }
  ~Streams() override { setenv("PATH", old_path.c_str(), 1); }

  /// Installs a program that stores its arguments in a file and runs the script.
  void program(const std::string& name, const std::string& script) {
    std::ofstream(folder / name) << "#!/bin/sh\nprintf '%s\\n' \"$@\" > '"
                                 << (folder / (name + ".arguments")).string() << "'\n"
                                 << script << "\n";
    fs::permissions(folder / name, fs::perms::owner_all);
  }

  std::vector<std::string> arguments(const std::string& name) {
    std::ifstream stream(folder / (name + ".arguments"));
    std::vector<std::string> words;
    for (std::string word; std::getline(stream, word);) words.push_back(word);
    return words;
  }

  std::unique_ptr<FrameSource> open(const std::string& source, int width, int height) {
    CameraHandlers handlers;
    handlers.frame = [this](const CameraFrame& frame) {
      numbers.push_back(frame.number);
      rows.emplace_back(frame.grey.row(1), frame.grey.row(1) + frame.grey.width);
    };
    handlers.trouble = [this](const std::string& text) { troubles.push_back(text); };
    CameraFormat wanted;
    wanted.width = width;
    wanted.height = height;
    return dut.open(source, wanted, handlers);
  }

  std::string refusal(const std::string& source, int width, int height) {
    try {
      static_cast<void>(open(source, width, height));
    } catch (const CameraError& error) {
      return error.what();
    }
    return "opened";
  }

  std::string old_path = getenv("PATH");
  TemporaryFolder folder;
  AsioLoop loop;
  CameraDevices dut{loop, folder / "lab"};
  std::vector<std::int64_t> numbers;
  std::vector<std::vector<std::uint8_t>> rows;
  std::vector<std::string> troubles;
};

constexpr const char* kFacts =
    R"(echo '{"streams":[{"codec_name":"h264","pix_fmt":"yuv420p","width":2,"height":2,)"
    R"("avg_frame_rate":"25/1"}]}')";

TEST_F(Streams, FromTheNetworkAreConvertedToGrey) {
  program("ffprobe", kFacts);
  program("ffmpeg", "printf 'aaabbbcccddd'; printf 'aaabbbcccdef'; sleep 60");
  const auto source = open("rtsp://camera/1", 2, 2);

  ASSERT_TRUE(loopUntil(loop, [&] { return numbers.size() == 2; }));

  EXPECT_THAT(rows.at(0), ElementsAre('c', 'd'));
  EXPECT_THAT(rows.at(1), ElementsAre('c', 'e'));
  EXPECT_EQ(source->format().fps, 25);
  EXPECT_EQ(source->format().pixels, "yuv420p (h264)");
  EXPECT_TRUE(source->format().compressed);
  EXPECT_THAT(arguments("ffmpeg"),
              AllOf(Contains("rtsp://camera/1"), Contains("tcp"), Contains("passthrough")));
}

TEST_F(Streams, ThatEndAreReopened) {
  program("ffprobe", kFacts);
  program("ffmpeg", "printf 'aaabbbcccddd'; echo 'Connection timed out' >&2; exit 1");
  const auto source = open("http://camera/video", 0, 0);

  ASSERT_TRUE(loopUntil(loop, [&] { return numbers.size() == 2; }));

  EXPECT_THAT(numbers, ElementsAre(0, 1));
  ASSERT_GE(troubles.size(), 2U);
  EXPECT_THAT(troubles[0],
              AllOf(HasSubstr("http://camera/video: the camera is gone (Connection timed out)")));
  EXPECT_EQ(troubles[1], "") << "and it is back";
}

TEST_F(Streams, ThatCannotBeReachedAreRejected) {
  program("ffprobe", "echo 'Connection refused' >&2; exit 1");
  EXPECT_THAT(refusal("rtsp://camera/1", 2, 2), HasSubstr("Connection refused"));
  program("ffprobe", kFacts);
  EXPECT_THAT(refusal("rtsp://camera/1", 4, 2), HasSubstr("found 2 x 2 pixels, wanted 4 x 2"));
}

TEST_F(Streams, OfHugePicturesAreRejected) {
  program("ffprobe", R"(echo '{"streams":[{"codec_name":"h264","width":60000,"height":60000}]}')");
  EXPECT_THAT(refusal("rtsp://camera/1", 0, 0),
              HasSubstr("rtsp://camera/1: found 60000 x 60000 pixels, expected at most 200"));
}

TEST_F(Streams, OpenTheProtocolsOfACameraOnly) {
  program("ffprobe", kFacts);
  EXPECT_THAT(refusal("concat:file:///etc/passwd|http://a", 2, 2), HasSubstr("allowed rtsp://"));
  EXPECT_THAT(refusal("file:///dev/zero", 2, 2), HasSubstr("allowed rtsp://"));

  program("ffmpeg", "sleep 60");
  const auto source = open("http://camera/video", 2, 2);

  ASSERT_TRUE(loopUntil(loop, [&] { return !arguments("ffmpeg").empty(); }));
  EXPECT_THAT(arguments("ffmpeg"),
              AllOf(Contains("-protocol_whitelist"), Contains("http,https,tcp,tls,httpproxy")));
}

TEST_F(Streams, OfAPipelineHaveRowsPaddedToWords) {
  program("gst-launch-1.0", "printf 'abcde...fghij...'; sleep 60");
  const auto source = open("gst:aravissrc camera-name=\"A B\" ! queue", 5, 2);

  ASSERT_TRUE(loopUntil(loop, [&] { return numbers.size() == 1; }));

  EXPECT_THAT(rows.at(0), ElementsAre('f', 'g', 'h', 'i', 'j'));
  EXPECT_THAT(
      arguments("gst-launch-1.0"),
      ElementsAre("-q", "aravissrc", "camera-name=A B", "!", "queue", "!", "videoconvert", "!",
                  "video/x-raw,format=GRAY8,width=5,height=2,colorimetry=(string)1:4:0:0", "!",
                  "fdsink", "fd=1"));
}

TEST_F(Streams, OfAPipelineDoNotRunShellCommands) {
  EXPECT_THAT(refusal("gst:videotestsrc; touch x", 4, 4), HasSubstr("invalid pipeline"));
  EXPECT_THAT(refusal("gst:$(touch x)", 4, 4), HasSubstr("invalid pipeline"));
  EXPECT_THAT(refusal("gst:", 4, 4), HasSubstr("is empty"));
  EXPECT_THAT(refusal("gst:videotestsrc", 0, 0), HasSubstr("set width_px and height_px"));
}

TEST_F(Streams, WithoutTheirProgramTheErrorNamesThePackage) {
  setenv("PATH", (folder / "").c_str(), 1);
  EXPECT_THAT(refusal("rtsp://camera/1", 2, 2), HasSubstr("sudo apt install ffmpeg"));
  const auto source = open("gst:videotestsrc", 4, 4);

  ASSERT_TRUE(loopUntil(loop, [&] { return !troubles.empty(); }));

  EXPECT_THAT(troubles.front(), HasSubstr("sudo apt install gstreamer1.0-tools"));
}

TEST_F(Streams, MayBeClosedWhileTheyAreSilent) {
  program("ffprobe", kFacts);
  program("ffmpeg", "exec sleep 1000");

  EXPECT_EQ(refusal("rtsp://camera/1", 2, 2), "opened");
}

}  // namespace
}  // namespace lab
