#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/loop/asio_loop.hpp"
#include "common/serial/serial_devices.hpp"
#include "runner/commands/commands.hpp"
#include "tests/support/robot_on_bench.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder with a firmware and a script in place of avrdude that records its arguments.
class FlashTest : public testing::Test {
 protected:
  FlashTest() {
    fs::create_directories(folder_ / "bin");
    fs::create_directories(folder_ / "ports");
    std::ofstream(folder_ / "bin/robot_firmware.hex") << ":00000001FF\n";
    setAvrdude(0);
    setenv("PATH", ((folder_ / "bin").string() + ":" + old_path_).c_str(), 1);
    options_.programs = folder_ / "bin";
    options_.port = folder_ / "ports/robot";
  }
  ~FlashTest() override { setenv("PATH", old_path_.c_str(), 1); }

  void setAvrdude(int exit_code) {
    const fs::path script = folder_ / "bin/avrdude";
    std::ofstream(script) << "#!/bin/sh\necho \"$@\" >>" << (folder_ / "called").string()
                          << "\nexit " << exit_code << "\n";
    fs::permissions(script, fs::perms::owner_all);
  }

  /// The arguments of avrdude, one line per call.
  std::string called() const {
    const fs::path file = folder_ / "called";
    std::string lines = fs::exists(file) ? support::readFile(file) : "";
    if (!lines.empty()) lines.pop_back();  // the last end of line
    return lines;
  }

  /// Runs flash(). @return its output
  std::string flashed(ExitCode expected) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(flash(options_), expected);
    return testing::internal::GetCapturedStdout();
  }

  std::string refusal() {
    try {
      flash(options_);
    } catch (const UserError& error) {
      return error.what();
    }
    return "flashed";
  }

  TemporaryFolder folder_;
  FlashOptions options_;

 private:
  std::string old_path_ = std::getenv("PATH");
};

/// A robot at a pseudo terminal, in its own thread.
class RobotThread {
 public:
  explicit RobotThread(const fs::path& ports) {
    std::atomic<bool> ready = false;
    thread_ = std::thread([this, ports, &ready] { run(ports, ready); });
    while (!ready) std::this_thread::yield();
  }
  ~RobotThread() {
    ended_ = true;
    thread_.join();
  }

 private:
  void run(const fs::path& folder, std::atomic<bool>& ready) {
    AsioLoop loop;
    SerialDevices ports(loop, folder);
    const std::unique_ptr<SerialPort> line = ports.offer("robot");
    firmware::BenchBoard board;
    firmware::Device device(board, firmware::BootFacts());
    device.boot(0);
    std::uint32_t now_ms = 0;
    loop.every(1000, loop.now(), [&] {
      ++now_ms;
      std::array<std::uint8_t, 256> bytes{};
      for (std::size_t n = line->read(bytes); n > 0; n = line->read(bytes)) {
        for (std::size_t i = 0; i < n; ++i) device.receive(now_ms, 0, bytes[i]);
      }
      device.tick(now_ms);
      const std::vector<std::uint8_t> sent = board.passMs();
      (void)line->write(sent);
      if (ended_) loop.stop();
    });
    ready = true;
    loop.run();
  }

  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

TEST_F(FlashTest, FlashesARobotAndAssignsItsUid) {
  const RobotThread robot(folder_ / "ports");
  EXPECT_THAT(flashed(kDone),
              testing::ContainsRegex("firmware 2\\.0, .*uid = [0-9]+ .new, stored"));
  EXPECT_EQ(called(), "-q -p m328p -c arduino -P " + options_.port + " -b 57600 -D -U flash:w:" +
                          (folder_ / "bin/robot_firmware.hex").string() + ":i");
  // A second time the robot keeps its uid.
  EXPECT_THAT(flashed(kDone), testing::Not(HasSubstr("new, stored")));
}

TEST_F(FlashTest, WithAProgrammerSetsTheFuses) {
  const RobotThread robot(folder_ / "ports");
  options_.isp = "usbasp";
  flashed(kDone);
  // Two calls: the second one erases the chip, when the fuse that preserves the EEPROM is already
  // set.
  EXPECT_EQ(called(),
            "-q -p m328p -c usbasp -U lfuse:w:0xFF:m -U hfuse:w:0xD7:m -U "
            "efuse:w:0xFD:m\n-q -p m328p -c usbasp -U flash:w:" +
                (folder_ / "bin/robot_firmware.hex").string() + ":i");
}

TEST_F(FlashTest, ReportsAFailureOfAvrdude) {
  const RobotThread robot(folder_ / "ports");
  setAvrdude(1);
  EXPECT_THAT(flashed(kFailed), HasSubstr("NOT flashed: avrdude failed with exit code 1"));
}

TEST_F(FlashTest, NeedsAPortAndAFirmware) {
  EXPECT_THAT(refusal(), HasSubstr(options_.port));
  EXPECT_EQ(called(), "") << "nothing was started";
  fs::remove(folder_ / "bin/robot_firmware.hex");
  EXPECT_THAT(refusal(), HasSubstr("robot_firmware.hex does not exist"));
}

}  // namespace
}  // namespace lab::runner
