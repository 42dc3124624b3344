#include "sim_svc/emulator/lockstep.hpp"

#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <system_error>

#include "sim_svc/bodies/chip_link.hpp"

namespace lab::emulator {
namespace {

void append(std::vector<std::uint8_t>& packet, const void* bytes, std::size_t size) {
  const std::size_t at = packet.size();
  packet.resize(at + size);
  if (size > 0) {
    std::memcpy(packet.data() + at, bytes, size);
  }
}

template <class Plain>
void append(std::vector<std::uint8_t>& packet, const Plain& value) {
  append(packet, &value, sizeof(Plain));
}

std::vector<std::uint8_t> packetOf(chip::Packet kind, std::int64_t at_us, std::size_t robots) {
  chip::Header header;
  header.packet = kind;
  header.until_us = at_us;
  header.robots = static_cast<std::uint32_t>(robots);
  std::vector<std::uint8_t> packet;
  append(packet, header);
  return packet;
}

chip::ChipState stateOf(ChipPower power) {
  switch (power) {
    case ChipPower::kOff:
      return chip::ChipState::kOff;
    case ChipPower::kCrashed:
      return chip::ChipState::kCrashed;
    case ChipPower::kHeld:
    case ChipPower::kRunning:
      break;
  }
  return chip::ChipState::kRunning;
}

}  // namespace

/// Reads plain values from a packet.
class Lockstep::Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> packet) : left_(packet) {}

  template <class Plain>
  Plain take() {
    Plain value{};
    std::memcpy(&value, bytes(sizeof(Plain)).data(), sizeof(Plain));
    return value;
  }

  std::span<const std::uint8_t> bytes(std::size_t size) {
    if (size > left_.size()) {
      throw LinkError("arena socket: a packet ends " + std::to_string(size - left_.size()) +
                      " bytes early; both programs must come from one build");
    }
    const auto taken = left_.first(size);
    left_ = left_.subspan(size);
    return taken;
  }

  void expectEnd() const {
    if (!left_.empty()) {
      throw LinkError("arena socket: a packet is " + std::to_string(left_.size()) +
                      " bytes too long; both programs must come from one build");
    }
  }

 private:
  std::span<const std::uint8_t> left_;
};

std::vector<std::uint8_t> Lockstep::answer(std::span<const std::uint8_t> packet) {
  Reader reader(packet);
  const auto header = reader.take<chip::Header>();
  if (header.version != chip::kLinkVersion) {
    throw LinkError("arena socket: version " + std::to_string(header.version) + "; expected " +
                    std::to_string(chip::kLinkVersion) + ", as of this build");
  }
  if (header.packet == chip::Packet::kSetup && !set_up_) {
    setUp(reader, header.robots, header.until_us);
    set_up_ = true;
    return packetOf(chip::Packet::kReady, header.until_us, robots_.size());
  }
  if (header.packet != chip::Packet::kStep || !set_up_) {
    throw LinkError("arena socket: packet " +
                    std::to_string(static_cast<std::uint32_t>(header.packet)) +
                    (set_up_ ? "; expected STEP" : "; expected SETUP"));
  }
  if (header.robots != robots_.size()) {
    throw LinkError("arena socket: a step for " + std::to_string(header.robots) +
                    " robots; expected the " + std::to_string(robots_.size()) + " of the setup");
  }
  step(reader, header.until_us);
  return outputs(header.until_us);
}

void Lockstep::setUp(Reader& reader, std::uint32_t robots, std::int64_t now_us) {
  for (std::uint32_t i = 0; i < robots; ++i) {
    const auto setup = reader.take<chip::ChipSetup>();
    const auto eeprom = reader.bytes(setup.eeprom_size);
    if (setup.eeprom_size > kEepromSize || !(setup.clock_rate > 0.5 && setup.clock_rate < 2)) {
      throw LinkError("arena socket: robot " + std::to_string(setup.id) + " has an EEPROM of " +
                      std::to_string(setup.eeprom_size) + " bytes and a clock rate of " +
                      std::to_string(setup.clock_rate) + "; expected at most " +
                      std::to_string(kEepromSize) + " and 0.5 to 2");
    }
    RobotSettings settings;
    settings.eeprom.assign(eeprom.begin(), eeprom.end());
    settings.boot_us = setup.boot_us;
    settings.clock_rate = setup.clock_rate;
    settings.seed = static_cast<std::uint64_t>(static_cast<std::uint32_t>(setup.id));
    robots_.push_back(std::make_unique<EmulatedRobot>(program_, settings, now_us));
  }
  reader.expectEnd();
}

void Lockstep::step(Reader& reader, std::int64_t until_us) {
  for (const auto& robot : robots_) {
    const auto input = reader.take<chip::ChipInput>();
    AnalogInputs inputs;
    std::copy(std::begin(input.ir), std::end(input.ir), inputs.ir.begin());
    inputs.light_front = input.light_front;
    inputs.light_back = input.light_back;
    robot->sense(inputs);
    robot->receive(reader.bytes(input.rx_size));
  }
  reader.expectEnd();
  for (const auto& robot : robots_) {
    robot->advance(until_us);
  }
}

std::vector<std::uint8_t> Lockstep::outputs(std::int64_t until_us) {
  auto packet = packetOf(chip::Packet::kStepped, until_us, robots_.size());
  for (const auto& robot : robots_) {
    const auto changes = robot->takeChanges();
    const auto sent = robot->takeSent();
    chip::ChipOutput output;
    output.state = stateOf(robot->chip().power());
    output.resets = robot->chip().counts().resets;
    output.changes = static_cast<std::uint32_t>(changes.size());
    output.tx_size = static_cast<std::uint32_t>(sent.size());
    append(packet, output);
    for (const DutyAt& change : changes) {
      chip::WheelChange wheels;
      wheels.at_us = change.at_us;
      wheels.left = change.duty.left;
      wheels.right = change.duty.right;
      append(packet, wheels);
    }
    append(packet, sent.data(), sent.size());
  }
  if (packet.size() > chip::kLargestPacket) {
    throw LinkError("arena socket: an answer of " + std::to_string(packet.size()) +
                    " bytes; at most " + std::to_string(chip::kLargestPacket) +
                    " fit: take shorter steps");
  }
  return packet;
}

std::vector<std::uint8_t> failedPacket(const std::string& why) {
  auto packet = packetOf(chip::Packet::kFailed, 0, 0);
  append(packet, why.data(), why.size());
  return packet;
}

namespace {

void sendPacket(int socket, const std::vector<std::uint8_t>& packet) {
  ssize_t sent = 0;
  do {
    sent = send(socket, packet.data(), packet.size(), MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  if (sent < 0 && errno != EPIPE && errno != ECONNRESET) {
    throw LinkError("arena socket: cannot send: " + std::generic_category().message(errno));
  }
}

/// @return false if the other end has closed the socket.
bool receivePacket(int socket, std::vector<std::uint8_t>& packet) {
  packet.resize(chip::kLargestPacket);
  ssize_t size = 0;
  do {
    size = recv(socket, packet.data(), packet.size(), MSG_TRUNC);
  } while (size < 0 && errno == EINTR);
  if (size < 0 && errno != ECONNRESET) {
    throw LinkError("arena socket " + std::to_string(socket) + ": cannot receive: " +
                    std::generic_category().message(errno) + "; sim_svc starts this program");
  }
  if (size > static_cast<ssize_t>(chip::kLargestPacket)) {
    throw LinkError("arena socket: a packet of " + std::to_string(size) + " bytes; at most " +
                    std::to_string(chip::kLargestPacket) + " are read");
  }
  packet.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  return size > 0;
}

}  // namespace

int serveArena(int socket, const std::filesystem::path& elf) {
  try {
    Lockstep lockstep(std::make_shared<const FirmwareImage>(elf));
    std::vector<std::uint8_t> packet;
    while (receivePacket(socket, packet)) {
      sendPacket(socket, lockstep.answer(packet));
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "robot_emulator: " << error.what() << '\n';
    const auto failed = failedPacket(error.what());
    static_cast<void>(send(socket, failed.data(), failed.size(), MSG_NOSIGNAL));
    return 1;
  }
}

}  // namespace lab::emulator
