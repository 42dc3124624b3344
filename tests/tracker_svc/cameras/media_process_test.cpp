#include "tracker_svc/cameras/media_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <string_view>
#include <vector>

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

/// The list of the packets of a film may be of any length.
TEST(MediaProcess, GivesLinesBeforeTheOutputEnds) {
  MediaProcess dut({"yes", "a packet"}, "film: read by", "package");
  int count = 0;
  dut.readLines([&](std::string_view line) {
    EXPECT_EQ(line, "a packet");
    return ++count < 100'000;
  });
  EXPECT_EQ(count, 100'000);
}

TEST(MediaProcess, GivesEveryLineOnce) {
  MediaProcess dut({"sh", "-c", "seq 100000; printf end"}, "film: read by", "package");
  int count = 0;
  std::string last;
  dut.readLines([&](std::string_view line) {
    last = line;
    ++count;
    EXPECT_TRUE(line == std::to_string(count) || line == "end") << line;
    return true;
  });
  EXPECT_EQ(count, 100'001);
  EXPECT_EQ(last, "end");
  EXPECT_EQ(dut.finish(), 0);
}

TEST(MediaProcess, LimitsAnswersAndLines) {
  const std::vector<std::string> endless{"sh", "-c", "yes | tr -d '\\n'"};
  MediaProcess answer(endless, "film: read by", "package");
  MediaProcess line(endless, "film: read by", "package");
  EXPECT_THAT([&] { static_cast<void>(answer.readAll()); },
              testing::ThrowsMessage<CameraError>(
                  HasSubstr("film: read by sh: found more than 1 MB in its answer, expected")));
  EXPECT_THAT([&] { line.readLines([](std::string_view) { return true; }); },
              testing::ThrowsMessage<CameraError>(
                  HasSubstr("found more than 1 MB in a line of its answer")));
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
