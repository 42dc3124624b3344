// The connection to a host, with a script in place of ssh.
#include "runner/hosts/remote_host.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/temporary_folder.hpp"
#include "tests/support/wait_until.hpp"

namespace lab::runner::remote_host_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RemoteHostTest : public testing::Test {
 protected:
  RemoteHostTest() { setenv("PATH", (folder_.path().string() + ":" + path_).c_str(), 1); }
  ~RemoteHostTest() override { setenv("PATH", path_.c_str(), 1); }

  /// What is wrong with a host whose ssh is this shell script.
  [[nodiscard]] std::string troubleWith(const std::string& script) const {
    const fs::path ssh = folder_.path() / "ssh";
    std::ofstream(ssh) << "#!/bin/sh\n" << script;
    fs::permissions(ssh, fs::perms::owner_all);
    HostSpec spec;
    spec.name = "bench";
    spec.ssh = "pi@bench";
    RemoteHost dut(spec, 0.005);
    dut.connect();
    waitUntil(
        [&dut] {
          dut.attend();
          return dut.state() == RemoteHost::State::kGone;
        },
        std::chrono::seconds(20));
    return dut.trouble();
  }

 private:
  TemporaryFolder folder_;
  std::string path_ = std::getenv("PATH");
};

/// A banner, a debug level in ~/.ssh/config or a hostile server: 20 MB before the reason.
TEST_F(RemoteHostTest, TheLastMessagesOfSshCountHoweverMuchItPrints) {
  EXPECT_THAT(troubleWith("head -c 20000000 /dev/zero | tr '\\0' x >&2; echo >&2\n"
                          "echo 'ssh: connect to host bench port 22: Connection refused' >&2\n"
                          "exit 255\n"),
              HasSubstr("no ssh server answers there"));
}

TEST_F(RemoteHostTest, NamesTheEndingOfASilentSsh) {
  EXPECT_THAT(troubleWith("exit 255\n"), HasSubstr("ssh ended (exit code 255)"));
}

}  // namespace
}  // namespace lab::runner::remote_host_test
