#include "common/files/own_folder.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;

TEST(OwnFolder, IsARealFolder) {
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "text";
  fs::create_directory_symlink(folder.path(), folder / "link");

  EXPECT_TRUE(isOwnFolder(folder.path()));
  EXPECT_FALSE(isOwnFolder(folder / "link")) << "its owner can change where it leads";
  EXPECT_FALSE(isOwnFolder(folder / "file"));
  EXPECT_FALSE(isOwnFolder(folder / "nothing"));
}

TEST(OwnFolder, BelongsToThisUser) {
  constexpr uid_t kNobody = 65534;
  const TemporaryFolder folder;
  if (chown(folder.path().c_str(), kNobody, static_cast<gid_t>(-1)) != 0) {
    GTEST_SKIP() << "only root may give a folder away";
  }
  EXPECT_FALSE(isOwnFolder(folder.path()));
}

}  // namespace
}  // namespace lab
