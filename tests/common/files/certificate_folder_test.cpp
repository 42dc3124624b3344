#include "common/files/certificate_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::certificate_folder_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class CertificateFolder : public testing::Test {
 protected:
  CertificateFolder() : certificates(parent_ / "lab-pc") { fill(certificates); }

  static void fill(const fs::path& folder) {
    for (const std::string_view file : kSecurityFiles) support::writeFile(folder / file, "x");
  }

  void replaceKeyByLinkTo(const fs::path& target) const {
    fs::remove(certificates / "key.pem");
    fs::create_symlink(target, certificates / "key.pem");
  }

 private:
  TemporaryFolder parent_;

 protected:
  const fs::path certificates;
};

TEST_F(CertificateFolder, OfSixFilesIsUsed) {
  EXPECT_EQ(securityFolderProblem(certificates), "");
  EXPECT_EQ(securityFolderProblem(certificates / ""), "");
  const fs::path link = certificates.parent_path() / "link";
  fs::create_directory_symlink(certificates, link);
  EXPECT_EQ(securityFolderProblem(link), "");
}

TEST_F(CertificateFolder, MayHaveLinksToItsOwnFiles) {
  support::writeFile(certificates / "2026/key.pem", "y");
  replaceKeyByLinkTo("2026/key.pem");
  EXPECT_EQ(securityFolderProblem(certificates), "");
}

TEST_F(CertificateFolder, WithALinkOutOfItIsRefused) {
  const fs::path secret = certificates.parent_path() / "secret";
  support::writeFile(secret, "password");
  // The name of the second folder begins like that of the first.
  const fs::path similar = certificates.parent_path() / "lab-pc-2";
  fill(similar);
  for (const fs::path& target : {secret, fs::path("../secret"), similar / "key.pem"}) {
    replaceKeyByLinkTo(target);
    EXPECT_THAT(securityFolderProblem(certificates),
                AllOf(HasSubstr("key.pem: found a link to "), HasSubstr("outside of the folder"),
                      HasSubstr("replace the link by a copy of that file")));
  }
}

TEST_F(CertificateFolder, WithoutOneOfTheFilesIsRefused) {
  for (const std::string_view file : kSecurityFiles) {
    fs::remove(certificates / file);
    EXPECT_THAT(securityFolderProblem(certificates),
                AllOf(HasSubstr(std::string(file) + ": not found"), HasSubstr("docs/security.md")));
    support::writeFile(certificates / file, "x");
  }
}

TEST_F(CertificateFolder, WithAnythingButSmallRegularFilesIsRefused) {
  const fs::path key = certificates / "key.pem";
  fs::remove(key);
  ASSERT_EQ(mkfifo(key.c_str(), 0600), 0);
  EXPECT_THAT(securityFolderProblem(certificates), HasSubstr("key.pem: not found, or no regular"));
  replaceKeyByLinkTo("/dev/zero");
  EXPECT_THAT(securityFolderProblem(certificates), HasSubstr("key.pem: not found, or no regular"));
  fs::remove(key);
  support::writeFile(key, std::string(1'000'001, 'x'));
  EXPECT_THAT(securityFolderProblem(certificates), HasSubstr("of at most 1 MB"));
}

/// As long as it lives, this process may not read what only its user may.
class AsAnotherUser {
 public:
  AsAnotherUser() : is_root_(geteuid() == 0), is_other_(!is_root_ || seteuid(kNobody) == 0) {}
  ~AsAnotherUser() {
    if (is_root_) static_cast<void>(!seteuid(0));
  }
  AsAnotherUser(const AsAnotherUser&) = delete;
  AsAnotherUser& operator=(const AsAnotherUser&) = delete;

  [[nodiscard]] bool isOther() const { return is_other_; }

 private:
  static constexpr uid_t kNobody = 65534;
  bool is_root_;
  bool is_other_;
};

TEST_F(CertificateFolder, OfAnotherUserIsAsAbsentOrRefused) {
  fs::permissions(certificates.parent_path(), fs::perms::all);
  for (const fs::path& secret : {certificates / "key.pem", certificates}) {
    fs::permissions(secret, fs::perms::none);
    std::string checked;
    std::string required;
    {
      const AsAnotherUser user;
      if (!user.isOther()) GTEST_SKIP() << "root cannot become another user here";
      checked = securityFolderProblem(certificates, Unreadable::kIsAbsent);
      required = securityFolderProblem(certificates);
    }
    fs::permissions(secret, fs::perms::owner_all);
    EXPECT_EQ(checked, "") << secret;
    EXPECT_THAT(required, HasSubstr(".pem: no permission to read it, expected")) << secret;
  }
  EXPECT_EQ(securityFolderProblem(certificates), "");
}

TEST_F(CertificateFolder, OfANameThatCouldContinueADocumentIsRefused) {
  for (const std::string name : {"a</IdentityCA>", "a&b", "$HOME", "a\nb"}) {
    const fs::path folder = certificates.parent_path() / name / "x";
    EXPECT_THAT(securityNameProblem(folder), HasSubstr("rename it"));
    fill(folder);
    EXPECT_THAT(securityFolderProblem(folder), HasSubstr("rename it"));
  }
  EXPECT_EQ(securityNameProblem("keys of the lab/lab-pc"), "");
}

}  // namespace
}  // namespace lab::certificate_folder_test
