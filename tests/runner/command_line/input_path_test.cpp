#include "runner/command_line/input_path.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "common/files/file_text.hpp"
#include "runner/command_line/exit_code.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner {
namespace {

constexpr FileKind kRun{"the folder of a run or a log", 10};

std::string refusalOf(const std::filesystem::path& input) {
  try {
    requireFolderOrFile(input, kRun);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(InputPathTest, TakesFoldersAndRegularFiles) {
  const TemporaryFolder folder;
  support::writeFile(folder / "log", "0123456789");
  EXPECT_EQ(refusalOf(folder.path()), "");
  EXPECT_EQ(refusalOf(folder / "log"), "");
}

TEST(InputPathTest, SaysWhatItFoundInstead) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusalOf(folder / "none"),
            (folder / "none").string() + ": found nothing, expected the folder of a run or a log");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(refusalOf(folder / "pipe"),
            (folder / "pipe").string() +
                ": found a pipe, expected the folder of a run or a log: copy the content into a "
                "regular file and name that");
  EXPECT_THAT(refusalOf("/dev/null"), testing::StartsWith("/dev/null: found a device"));
  support::writeFile(folder / "long", "01234567890");
  EXPECT_THAT(refusalOf(folder / "long"), testing::HasSubstr("found 11 bytes"));
}

}  // namespace
}  // namespace lab::runner
