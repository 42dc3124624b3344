// In real time on pseudo terminals. No times are tested; each wait ends when its condition is met.
#include "sim_svc/emulator/free_run.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <span>

#include "tests/sim_svc/emulator/robot_on_chip.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::emulator {
namespace {

constexpr std::int64_t kPatienceUs = 20'000'000;

/// A host on one of the lines, in the same loop as the robots.
class Client {
 public:
  Client(AsioLoop& loop, SerialDevices& devices, const std::string& name)
      : loop_(loop), port_(devices.open(name, 38400)) {
    port_->onReadable([this] { read(); });
  }

  template <class Message>
  void send(const Message& message) {
    wire::Frame frame;
    wire::pack(message, ++seq_, frame);
    std::array<std::uint8_t, wire::kMaxFrame> bytes{};
    const std::uint8_t size = wire::encode(frame, bytes.data());
    EXPECT_EQ(port_->write(std::span(bytes).first(size)), size);
  }

  /// Runs the loop until a message of this type comes.
  template <class Message>
  std::optional<Message> wait() {
    std::optional<Message> found;
    const std::int64_t until = loop_.now() + kPatienceUs;
    loop_.at(until, [this] { loop_.stop(); });
    on_frame_ = [&](const wire::Frame& frame) {
      Message message;
      if (wire::unpack(frame, message)) {
        found = message;
        loop_.stop();
      }
    };
    loop_.run();
    on_frame_ = nullptr;
    return found;
  }

 private:
  void read() {
    std::array<std::uint8_t, 256> bytes{};
    const std::size_t size = port_->read(bytes);
    for (std::size_t i = 0; i < size; ++i) {
      if (decoder_.push(bytes[i]) && on_frame_) on_frame_(decoder_.frame());
    }
  }

  AsioLoop& loop_;
  std::unique_ptr<SerialPort> port_;
  wire::Decoder decoder_;
  std::function<void(const wire::Frame&)> on_frame_;
  std::uint8_t seq_ = 0;
};

FreeRunSettings settingsFor(const TemporaryFolder& folder) {
  FreeRunSettings settings;
  settings.elf = LAB_FIRMWARE_ELF;
  settings.ports = folder.path() / "ports";
  settings.robots = 2;
  settings.light = 300;
  return settings;
}

std::string pathOf(const FreeRunSettings& settings, const char* name) {
  return (settings.ports / name).string();
}

TEST(FreeRun, RobotsAnswerOnTheirPorts) {
  const TemporaryFolder folder;
  AsioLoop loop;
  const FreeRunSettings settings = settingsFor(folder);
  FreeRun robots(loop, settings);
  SerialDevices devices(loop, settings.ports);
  Client client(loop, devices, pathOf(settings, "robot_02"));
  const auto hello = client.wait<wire::Hello>();
  ASSERT_TRUE(hello.has_value());
  EXPECT_EQ(hello->uid, 0x51000002U);
  client.send(wire::Ping{1, 2});
  EXPECT_TRUE(client.wait<wire::Pong>().has_value());
  const auto telemetry = client.wait<wire::Telemetry>();
  ASSERT_TRUE(telemetry.has_value());
}

TEST(FreeRun, OpeningALineCanResetTheChipAsDtrDoes) {
  const TemporaryFolder folder;
  AsioLoop loop;
  FreeRunSettings settings = settingsFor(folder);
  settings.reset_on_open = true;
  FreeRun robots(loop, settings);
  SerialDevices devices(loop, settings.ports);
  Client client(loop, devices, pathOf(settings, "robot_01"));
  const auto hello = client.wait<wire::Hello>();
  ASSERT_TRUE(hello.has_value());
  EXPECT_EQ(hello->reset_cause, wire::kResetPin);
  EXPECT_THAT(robots.summary(), testing::HasSubstr("1 resets"));
}

TEST(FreeRun, EepromsAreKeptBetweenRuns) {
  const TemporaryFolder folder;
  FreeRunSettings settings = settingsFor(folder);
  settings.eeproms = folder.path() / "eeproms";
  {
    AsioLoop loop;
    FreeRun robots(loop, settings);
    SerialDevices devices(loop, settings.ports);
    Client client(loop, devices, pathOf(settings, "robot_01"));
    ASSERT_TRUE(client.wait<wire::Hello>().has_value());  // it has booted and receives
    client.send(wire::SetParam{wire::kUid, 0x1234567});
    ASSERT_TRUE(client.wait<wire::Ack>().has_value());
    client.send(wire::Commit{});
    ASSERT_TRUE(client.wait<wire::Ack>().has_value());
    robots.save();
  }
  AsioLoop loop;
  FreeRun robots(loop, settings);
  SerialDevices devices(loop, settings.ports);
  Client client(loop, devices, pathOf(settings, "robot_01"));
  const auto hello = client.wait<wire::Hello>();
  ASSERT_TRUE(hello.has_value());
  EXPECT_EQ(hello->uid, 0x1234567U);
}

TEST(FreeRun, ReportsAMissingFirmwareInOneLine) {
  const TemporaryFolder folder;
  FreeRunSettings settings = settingsFor(folder);
  settings.elf = folder.path() / "none.elf";
  testing::internal::CaptureStderr();
  EXPECT_EQ(freeRun(settings), 2);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr("none.elf: cannot be read; expected"));
}

}  // namespace
}  // namespace lab::emulator
