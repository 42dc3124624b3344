#include "common/service/stop_coordinator.hpp"

#include <algorithm>
#include <utility>

namespace lab {
namespace {

constexpr std::size_t kMostKnown = 64;

}  // namespace

void StopCoordinator::request(std::string by, std::string reason, std::int64_t seq,
                              std::int8_t clear, std::int64_t now) {
  robot_stop_t message{};
  message.seq = seq;
  message.clear = clear;
  message.reason = std::move(reason);
  begin(message, std::move(by), true, now);
}

void StopCoordinator::begin(const robot_stop_t& request, std::string by, bool own,
                            std::int64_t now) {
  known_.push_back(request.seq);
  if (known_.size() > kMostKnown) known_.pop_front();
  requested_ = true;
  own_ = own;
  inferred_ = false;
  by_ = std::move(by);
  request_ = request;
  begun_utime_ = now;
  sent_utime_ = 0;
  response_time_us_.reset();
  for (auto& [robot, complies] : complies_) complies = false;
}

void StopCoordinator::take(const robot_stop_t& stop, std::int64_t now) {
  if (std::ranges::find(known_, stop.seq) != known_.end()) return;
  robot_stop_t request = stop;
  std::ranges::sort(request.robot_ids);
  begin(request, stop.sender, false, now);
}

void StopCoordinator::take(const robot_status_t& status, std::int64_t now) {
  if (!requested_) inferRequest(status, now);
  for (const robot_state_t& robot : status.robots) {
    if (robot.origin == robot_state_t::REPLAY) {
      complies_.erase(robot.robot_id);
      continue;
    }
    const bool has_place = complies_.size() < kMostRobots || complies_.contains(robot.robot_id);
    if (has_place) complies_[robot.robot_id] = compliesWithRequest(robot);
  }
  if (!response_time_us_ && !inferred_ && confirmed()) response_time_us_ = now - begun_utime_;
  const auto complies = [](const auto& robot) { return robot.second; };
  if (inferred_ && std::ranges::none_of(complies_, complies))
    requested_ = inferred_ = false;  // released unseen
}

void StopCoordinator::inferRequest(const robot_status_t& status, std::int64_t now) {
  for (const robot_state_t& robot : status.robots) {
    const bool stopped = (robot.flags & robot_state_t::FLAG_STOPPED) != 0;
    if (!stopped || robot.origin == robot_state_t::REPLAY) continue;
    robot_stop_t request{};
    request.seq = robot.stop_seq;
    begin(request, "", false, now);
    // Not a known seq yet: a repetition of the request will tell who requested it, and why.
    known_.pop_back();
    inferred_ = true;
    return;
  }
}

void StopCoordinator::newRun() {
  if (!own_ || state() == State::kFree) {
    *this = StopCoordinator();
  } else {
    complies_.clear();
  }
}

bool StopCoordinator::compliesWithRequest(const robot_state_t& robot) const {
  const bool stopped = (robot.flags & robot_state_t::FLAG_STOPPED) != 0;
  if (!requested_) return false;
  // A release also holds for robots that appeared later and were never stopped.
  if (request_.clear != 0) return !stopped;
  return stopped && (inferred_ || robot.stop_seq == request_.seq);
}

bool StopCoordinator::isAddressed(std::int32_t robot) const {
  // A message may name millions.
  const auto& ids = request_.robot_ids;
  return ids.empty() || std::ranges::binary_search(ids, robot);
}

std::vector<std::int32_t> StopCoordinator::unconfirmed() const {
  std::vector<std::int32_t> ids;
  if (!requested_) return ids;
  for (const auto& [robot, complies] : complies_) {
    if (!complies && isAddressed(robot)) ids.push_back(robot);
  }
  return ids;
}

std::size_t StopCoordinator::total() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      complies_, [this](const auto& robot) { return isAddressed(robot.first); }));
}

bool StopCoordinator::confirmed() const {
  return requested_ && total() > 0 && unconfirmed().empty();
}

StopCoordinator::State StopCoordinator::state() const {
  if (!requested_) return State::kFree;
  if (request_.clear != 0) return confirmed() ? State::kFree : State::kReleasing;
  return confirmed() ? State::kStopped : State::kStopping;
}

std::optional<robot_stop_t> StopCoordinator::due(std::int64_t now) {
  const bool discovering = now - begun_utime_ < kDiscovery_us;
  if (!requested_ || !own_ || (confirmed() && !discovering)) return std::nullopt;
  const bool has_timeout = request_.clear != 0 || total() == 0;
  if (has_timeout && now - begun_utime_ > kTimeout_us) return std::nullopt;
  if (sent_utime_ != 0 && now - sent_utime_ < kRepeat_us) return std::nullopt;
  sent_utime_ = now;
  request_.utime = now;
  return request_;
}

}  // namespace lab
