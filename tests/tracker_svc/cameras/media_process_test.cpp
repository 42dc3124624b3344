#include "tracker_svc/cameras/media_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>

#include "common/camera/cameras.hpp"

namespace lab::cameras::media_process_test {
namespace {

using testing::HasSubstr;

/// A damaged film: ffmpeg prints a line for every block, for hours.
TEST(MediaProcess, KeepsTheEndOfWhatItComplainsAbout) {
  MediaProcess dut({"sh", "-c",
                    "head -c 10000000 /dev/zero | tr '\\0' x >&2; printf picture; "
                    "echo >&2; echo last line >&2"},
                   "film: read by", "package");
  EXPECT_EQ(dut.readAll(), "picture");
  EXPECT_EQ(dut.finish(), 0);
  EXPECT_EQ(dut.errors().size(), 4096U);
  EXPECT_EQ(dut.lastErrorLine(), "last line");
}

TEST(MediaProcess, DoesNotWaitForAReaderOfItsComplaintsAtTheEnd) {
  MediaProcess dut({"sh", "-c", "head -c 1000000 /dev/zero >&2; exit 3"}, "film: read by",
                   "package");
  EXPECT_EQ(dut.finish(), 3);
}

TEST(MediaProcess, NamesThePackageOfAMissingProgram) {
  try {
    const MediaProcess dut({"no-such-program"}, "film: read by", "package");
    FAIL() << "it was started";
  } catch (const CameraError& error) {
    EXPECT_THAT(error.what(), HasSubstr("film: read by the program no-such-program, which is not "
                                        "installed: sudo apt install package"));
  }
}

TEST(MediaProcess, CanBeKilledWithItsChildren) {
  MediaProcess dut({"sh", "-c", "sleep 60 & wait"}, "film: read by", "package");
  dut.kill();
  EXPECT_EQ(dut.readAll(), "");
  EXPECT_EQ(dut.finish(), 128 + SIGKILL);
}

}  // namespace
}  // namespace lab::cameras::media_process_test
