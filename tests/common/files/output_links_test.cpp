#include "common/files/output_links.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;

TEST(OutputLinks, ExplainsALinkAlsoIfItLeadsNowhere) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "real");
  fs::create_directory_symlink(folder.path() / "real", folder.path() / "link");
  fs::create_symlink(folder.path() / "nothing", folder.path() / "broken");

  EXPECT_EQ(explainLink(folder.path() / "real"), "");
  EXPECT_EQ(explainLink(folder.path() / "nothing"), "");
  EXPECT_THAT(explainLink(folder.path() / "link"),
              testing::AllOf(testing::HasSubstr("link: found a symbolic link"),
                             testing::HasSubstr("--out")));
  EXPECT_NE(explainLink(folder.path() / "broken"), "");
}

TEST(OutputLinks, RemovesTheLinkAndNotWhereItLeads) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "kept") << "kept";
  fs::create_symlink(folder.path() / "kept", folder.path() / "link");

  removeLink(folder.path() / "link");
  removeLink(folder.path() / "kept");
  removeLink(folder.path() / "nothing");

  EXPECT_FALSE(fs::is_symlink(folder.path() / "link"));
  EXPECT_TRUE(fs::exists(folder.path() / "kept"));
}

}  // namespace
}  // namespace lab
