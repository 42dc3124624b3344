#include "sim_svc/bodies/wire_robots.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "robot/wire/messages.hpp"

namespace lab::sim {
namespace {

constexpr double kBitsPerByte = 10;           // start, eight data bits, stop
constexpr std::uint8_t kHostBoard = 2;        // wire::Hello::board
constexpr std::uint16_t kEnoughStack = 1024;  // bytes; not measured on a host

RobotClock clockFrom(std::int64_t boot_us, double rate) {
  return RobotClock(-1e-3 * static_cast<double>(boot_us) * rate, rate);
}

}  // namespace

WireRobot::WireRobot(const WireSetup& setup, std::int64_t boot_us, double clock_rate)
    : setup_(setup),
      rate_(clock_rate),
      byte_us_(1e6 * kBitsPerByte / setup.baud),
      store_(firmware::kStoreSize) {
  firmware::encodeStore(setup.settings, store_.data());
  switchOn(boot_us, wire::kResetPower);
}

void WireRobot::switchOn(std::int64_t at_us, std::uint8_t cause) {
  clock_ = clockFrom(at_us, rate_);
  next_ms_ = 0;
  reset_cause_ = cause;
  firmware::BootFacts facts;
  facts.reset_cause = cause;
  facts.board = kHostBoard;
  facts.baud = static_cast<std::uint32_t>(setup_.baud);
  firmware::Board& board = *this;
  device_.emplace(board, facts);
  incoming_.clear();
  waiting_.clear();
  under_way_.reset();
  now_us_ = static_cast<double>(at_us);
}

void WireRobot::reset(std::int64_t now_us) {
  switchOn(now_us, wire::kResetPin);
  setMotors(0, 0);  // in reset the pins float, and the driver is in standby
}

void WireRobot::receive(std::int64_t now_us, std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  if (incoming_.empty()) {
    received_us_ = std::max(received_us_, static_cast<double>(now_us)) + byte_us_;
  }
  const std::size_t room = kLineBuffer - incoming_.size();
  const auto taken = bytes.first(std::min(room, bytes.size()));
  incoming_.insert(incoming_.end(), taken.begin(), taken.end());
}

void WireRobot::advance(World& world, std::int64_t until_us) {
  sent_.clear();
  const auto until = static_cast<double>(until_us);
  for (;;) {
    const double tick_us = 1e6 * clock_.worldTime(next_ms_);
    const bool byte_first = !incoming_.empty() && received_us_ < tick_us;
    now_us_ = byte_first ? received_us_ : tick_us;
    if (now_us_ > until) break;
    sendUntil(now_us_);
    if (byte_first) {
      receiveByte();
    } else {
      runTick(world);
    }
  }
  now_us_ = until;
  sendUntil(until);
  for (const MotorChange& change : changes_) {
    world.setMotors(setup_.body, change);
  }
  changes_.clear();
}

void WireRobot::receiveByte() {
  const std::uint8_t byte = incoming_.front();
  incoming_.pop_front();
  if (!incoming_.empty()) received_us_ += byte_us_;
  if (next_ms_ == 0) return;  // the robot is not yet switched on
  const std::int64_t now_ms = next_ms_ - 1;
  const double since_us = (now_us_ - 1e6 * clock_.worldTime(now_ms)) * rate_;
  device_->receive(static_cast<std::uint32_t>(now_ms),
                   static_cast<std::uint16_t>(std::clamp(since_us, 0.0, 999.0)), byte);
}

void WireRobot::runTick(World& world) {
  const auto now_ms = static_cast<std::uint32_t>(next_ms_);
  if (next_ms_++ == 0) {
    device_->boot(0);
    return;
  }
  if (device_->scanDue(now_ms)) device_->sense(now_ms, world.measure(setup_.body));
  device_->tick(now_ms);
}

// Transmits until `time_us`. A byte leaves the buffer when its transmission starts, and arrives one
// byte duration later.
void WireRobot::sendUntil(double time_us) {
  while (line_free_us_ <= time_us) {
    if (under_way_) sent_.push_back(*under_way_);
    under_way_.reset();
    if (waiting_.empty()) return;
    under_way_ = waiting_.front();
    waiting_.pop_front();
    line_free_us_ += byte_us_ / rate_;
  }
}

bool WireRobot::send(const std::uint8_t* bytes, std::uint8_t size) {
  if (waiting_.size() + size > kSendBuffer) return false;
  waiting_.insert(waiting_.end(), bytes, bytes + size);
  line_free_us_ = std::max(line_free_us_, now_us_);
  sendUntil(now_us_);
  return true;
}

void WireRobot::setMotors(std::int16_t left, std::int16_t right) {
  if (left == left_ && right == right_) return;
  left_ = left;
  right_ = right;
  changes_.push_back({std::llround(now_us_), left, right});
}

std::uint8_t WireRobot::readStore(std::uint16_t address) const {
  return address < store_.size() ? store_[address] : 0xFF;
}

void WireRobot::writeStore(std::uint16_t address, std::uint8_t byte) {
  if (address < store_.size()) store_[address] = byte;
}

std::uint16_t WireRobot::stackLeft() const { return kEnoughStack; }

WireRobots::WireRobots(const World& world, const std::vector<WireSetup>& setups) {
  for (const WireSetup& setup : setups) {
    const std::int64_t boot_us = std::llround(1e6 * world.bootTime(setup.body));
    robots_.push_back(std::make_unique<WireRobot>(setup, boot_us, world.clock(setup.body).rate()));
  }
}

void WireRobots::advance(World& world, std::int64_t until_us) {
  for (const auto& robot : robots_) {
    robot->advance(world, until_us);
  }
  time_us_ = until_us;
}

std::int64_t WireRobots::program(std::size_t k) const {
  return robots_[k]->device().core().record().program;
}

}  // namespace lab::sim
