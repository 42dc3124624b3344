#include "common/camera/camera_place.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cerrno>
#include <string>

#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::camera_place_test {
namespace {

using testing::HasSubstr;

TEST(CameraPlace, MayBeAbsentOrAnAddress) {
  for (const std::string source :
       {"/dev/video-of-another-machine", "v4l2:/dev/video-of-another-machine", "none.mkv",
        "none/f*.png", "rtsp://camera/1", "gst:videotestsrc"}) {
    EXPECT_EQ(cameraPlaceProblem(source), "") << source;
  }
  EXPECT_EQ(videoDeviceError("/dev/video-of-another-machine"), ENOENT);
}

TEST(CameraPlace, OfAnotherDeviceIsRefused) {
  for (const std::string source : {"/dev/null", "v4l2:/dev/null", "/dev/../etc/passwd"}) {
    EXPECT_THAT(cameraPlaceProblem(source), HasSubstr("which is no video device")) << source;
  }
  EXPECT_EQ(videoDeviceError("/dev/null"), ENOTTY);
}

TEST(CameraPlace, OfAFilmIsAFileOrAFolder) {
  const TemporaryFolder folder;
  support::writeFile(folder / "film.mkv", "x");
  EXPECT_EQ(cameraPlaceProblem(folder / "film.mkv"), "");
  EXPECT_EQ(cameraPlaceProblem(folder / "."), "");
  ASSERT_EQ(mkfifo((folder / "pipe.mkv").c_str(), 0600), 0);
  EXPECT_THAT(cameraPlaceProblem(folder / "pipe.mkv"), HasSubstr("pipe.mkv: found a pipe"));
  EXPECT_THAT(cameraPlaceProblem("//dev/zero"), HasSubstr("found a device"));
  EXPECT_THAT(cameraPlaceProblem("/proc/self/environ"), HasSubstr("found a file of the kernel"));
}

}  // namespace
}  // namespace lab::camera_place_test
