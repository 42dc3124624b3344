// The connection to a host, with a script in place of ssh.
#include "runner/hosts/remote_host.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
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
  ~RemoteHostTest() override {
    setenv("PATH", path_.c_str(), 1);
    std::signal(SIGPIPE, pipe_handler_);
  }

  /// What is wrong with a host whose ssh is this shell script.
  [[nodiscard]] std::string troubleWith(const std::string& script) const {
    installSsh(script);
    RemoteHost dut(bench(), 0.005);
    dut.connect();
    waitUntil(
        [&dut] {
          dut.attend();
          return dut.state() == RemoteHost::State::kGone;
        },
        std::chrono::seconds(20));
    return dut.trouble();
  }

  /// Attends a host whose ssh prints this line so many times, until it ends. Calls `look` after
  /// each attend().
  void attendTo(
      const std::string& line, int times, const std::function<void()>& look = [] {}) const {
    installSsh("yes '" + line + "' | head -n " + std::to_string(times) + "\n");
    RemoteHost dut(bench(), 0.005);
    dut.connect();
    RemoteHost::RunSetup setup;
    setup.logs = log().parent_path();
    dut.begin(setup);
    waitUntil(
        [&] {
          dut.attend();
          look();
          return dut.state() == RemoteHost::State::kGone;
        },
        std::chrono::seconds(20));
    EXPECT_EQ(dut.state(), RemoteHost::State::kGone);
  }

  [[nodiscard]] fs::path log() const { return folder_.path() / "logs" / "sim_svc.txt"; }

  /// Of the output of sim_svc.
  [[nodiscard]] std::size_t lines() const {
    std::ifstream file(log());
    std::size_t count = 0;
    for (std::string line; std::getline(file, line);) ++count;
    return count;
  }

 private:
  void installSsh(const std::string& script) const {
    const fs::path ssh = folder_.path() / "ssh";
    std::ofstream(ssh) << "#!/bin/sh\n" << script;
    fs::permissions(ssh, fs::perms::owner_all);
  }

  static HostSpec bench() {
    HostSpec spec;
    spec.name = "bench";
    spec.ssh = "pi@bench";
    return spec;
  }

  TemporaryFolder folder_;
  std::string path_ = std::getenv("PATH");
  // A heartbeat may go to an ssh that has ended.
  void (*pipe_handler_)(int) = std::signal(SIGPIPE, SIG_IGN);
};

/// A banner, a debug level in ~/.ssh/config or a hostile server: 20 MB before the reason.
TEST_F(RemoteHostTest, TheLastMessagesOfSshCountHoweverMuchItPrints) {
  EXPECT_THAT(troubleWith("head -c 20000000 /dev/zero | tr '\\0' x >&2; echo >&2\n"
                          "echo 'ssh: connect to host bench port 22: Connection refused' >&2\n"
                          "exit 255\n"),
              HasSubstr("no ssh server answers there"));
}

/// A host that prints without end must not keep the runner from its other work.
TEST_F(RemoteHostTest, AFloodOfLinesIsReadInParts) {
  std::size_t most = 0;
  std::size_t before = 0;
  attendTo(R"({"say":"line","service":"sim_svc","text":"x"})", 5000, [&] {
    const std::size_t now = lines();
    most = std::max(most, now - before);
    before = now;
  });
  EXPECT_LE(most, 1000U);
  EXPECT_EQ(lines(), 5000U) << "all of them, though ssh has ended meanwhile";
}

TEST_F(RemoteHostTest, TheOutputOfAServiceIsBoundedAndTheFileSaysSo) {
  constexpr std::uintmax_t kLimit = 100'000'000;
  fs::create_directories(log().parent_path());
  std::ofstream(log()) << '\n';
  fs::resize_file(log(), kLimit - 20);  // takes no space
  attendTo(R"({"say":"line","service":"sim_svc","text":"12345"})", 3000);
  EXPECT_LT(fs::file_size(log()), kLimit + 100);
  std::ifstream file(log());
  file.seekg(kLimit - 20);
  const std::string end(std::istreambuf_iterator<char>(file), {});
  EXPECT_EQ(end, "12345\n12345\n12345\n12\n[further output is left out: this file has 100 MB]\n");
}

TEST_F(RemoteHostTest, NamesTheEndingOfASilentSsh) {
  EXPECT_THAT(troubleWith("exit 255\n"), HasSubstr("ssh ended (exit code 255)"));
}

}  // namespace
}  // namespace lab::runner::remote_host_test
