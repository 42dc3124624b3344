#include "robot_bridge/protocol/command_sender.hpp"

#include <utility>

namespace lab::bridge {
namespace {

constexpr int kTries = 3;

}  // namespace

void CommandSender::begin(const wire::Frame& command, std::int64_t now, std::int64_t timeout_us) {
  command_ = command;
  tries_ = 1;
  timeout_us_ = timeout_us;
  due_ = now + timeout_us;
}

std::optional<wire::Frame> CommandSender::answer(std::uint8_t type, std::uint8_t seq) {
  for (std::optional<wire::Frame>* waiting : {&command_, &given_up_}) {
    if (!*waiting || (*waiting)->type != type || (*waiting)->seq != seq) continue;
    return std::exchange(*waiting, std::nullopt);
  }
  return std::nullopt;
}

CommandSender::Due CommandSender::check(std::int64_t now) {
  if (!command_ || now < due_) return Due::kNothing;
  if (tries_ == kTries) {
    given_up_ = std::exchange(command_, std::nullopt);
    return Due::kGivenUp;
  }
  ++tries_;
  due_ = now + timeout_us_;
  return Due::kSendAgain;
}

}  // namespace lab::bridge
