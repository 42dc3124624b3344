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

TEST(OutputLinks, LeadOutOfAFolderOrStayInIt) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "run/film");
  std::ofstream(folder / "run/film/film.mkv") << "film";
  std::ofstream(folder / "private") << "private";
  const fs::path run = folder / "run";
  EXPECT_FALSE(leadsOutOf(run, run / "film/film.mkv"));
  EXPECT_FALSE(leadsOutOf(run, run / "film/../film/film.mkv"));
  EXPECT_TRUE(leadsOutOf(run, run / "../private"));
  EXPECT_TRUE(leadsOutOf(run, run / "nothing"));
  fs::create_symlink("../private", run / "file");
  fs::create_directory_symlink("..", run / "up");
  fs::create_symlink("film/film.mkv", run / "inside");
  EXPECT_TRUE(leadsOutOf(run, run / "file"));
  EXPECT_TRUE(leadsOutOf(run, run / "up/private"));
  EXPECT_FALSE(leadsOutOf(run, run / "inside"));
}

}  // namespace
}  // namespace lab
