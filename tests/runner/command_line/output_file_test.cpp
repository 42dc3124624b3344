#include "runner/command_line/output_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "runner/command_line/exit_code.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner {
namespace {

using testing::EndsWith;

std::string refusalOf(const std::filesystem::path& output, bool force) {
  try {
    checkOutput(output, force);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(OutputFileTest, ReplacesFilesOnlyWithForce) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusalOf(folder / "new", false), "");
  support::writeFile(folder / "old", "");
  EXPECT_THAT(refusalOf(folder / "old", false), EndsWith("or --force to replace it"));
  EXPECT_EQ(refusalOf(folder / "old", true), "");
}

/// A renamed file would replace the device, for every program of the machine.
TEST(OutputFileTest, ReplacesNoDevices) {
  for (const char* device : {"/dev/null", "/dev/full"}) {
    EXPECT_EQ(refusalOf(device, true), std::string(device) +
                                           ": is a device, a pipe or a socket, expected the name "
                                           "of a file");
  }
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(refusalOf(folder / "pipe", true), EndsWith("expected the name of a file"));
  EXPECT_THAT(refusalOf(folder.path(), true), EndsWith("is a folder, expected the name of a file"));
}

}  // namespace
}  // namespace lab::runner
