#include "common/files/file_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/files/experiment_error.hpp"
#include "common/process/file_descriptor.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

constexpr FileKind kKind{"a calibration", 10};

std::string problemOf(const fs::path& file) {
  try {
    static_cast<void>(readFileText(file, kKind));
  } catch (const ExperimentError& error) {
    return error.what();
  }
  return "none";
}

class FileText : public testing::Test {
 protected:
  fs::path write(const std::string& text) {
    std::ofstream(folder_ / "a.json", std::ios::binary) << text;
    return folder_ / "a.json";
  }
  TemporaryFolder folder_;
};

TEST_F(FileText, IsTheContentOfARegularFile) {
  const std::string text("a\0\n\xff", 4);
  EXPECT_EQ(readFileText(write(text), kKind), text);
  EXPECT_EQ(readFileText(write(""), kKind), "");
  fs::create_symlink(folder_ / "a.json", folder_ / "link");
  EXPECT_EQ(readFileText(folder_ / "link", kKind), "");
  EXPECT_EQ(readFileText(write("0123456789"), kKind), "0123456789");
}

TEST_F(FileText, OfMoreThanTheKindAllowsIsNotRead) {
  EXPECT_EQ(problemOf(write("0123456789a")),
            (folder_ / "a.json").string() +
                ": found 11 bytes, expected a calibration of at most 10: is it the right file?");
}

TEST_F(FileText, OfAPipeIsRefusedWithoutWaiting) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);

  EXPECT_EQ(problemOf(folder_ / "pipe"),
            (folder_ / "pipe").string() +
                ": found a pipe, expected a calibration: copy the content into a regular file and "
                "name that");
}

TEST_F(FileText, OfADeviceIsRefused) {
  EXPECT_THAT(problemOf("/dev/zero"), StartsWith("/dev/zero: found a device"));
  fs::create_symlink("/dev/zero", folder_ / "a.json");
  EXPECT_THAT(problemOf(folder_ / "a.json"), HasSubstr("a.json: found a device"));
}

TEST_F(FileText, OfASocketIsRefused) {
  const FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string path = folder_ / "socket";
  ASSERT_LT(path.size(), sizeof address.sun_path);
  path.copy(address.sun_path, path.size());
  ASSERT_EQ(bind(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);

  EXPECT_THAT(problemOf(path), HasSubstr("found a socket"));
}

TEST_F(FileText, OfTheKernelIsRefused) {
  EXPECT_THAT(problemOf("/proc/self/status"),
              StartsWith("/proc/self/status: found a file of the kernel"));
  EXPECT_THAT(problemOf("/proc/self/environ"), HasSubstr("found a file of the kernel"));
}

TEST_F(FileText, OfAFolderOrAMissingFileIsRefused) {
  EXPECT_THAT(problemOf(folder_.path()), EndsWith("is a folder, expected a file: a calibration"));
  EXPECT_THAT(problemOf(folder_ / "none"),
              EndsWith("none: cannot be read: No such file or directory"));
  EXPECT_EQ(readWholeFile(folder_ / "none"), std::nullopt);
}

TEST_F(FileText, HasTheSameProblemsForFilesThatAreReadInPieces) {
  EXPECT_EQ(regularFileProblem(write("0123456789"), kKind), "");
  EXPECT_THAT(regularFileProblem("/dev/zero", kKind), StartsWith("found a device"));
  EXPECT_THAT(regularFileProblem(folder_ / "none", kKind), StartsWith("cannot be read"));
}

}  // namespace
}  // namespace lab
