#include "common/service/stop_coordinator.hpp"

#include <algorithm>
#include <utility>

namespace lab {
namespace {

constexpr std::size_t kMostKnown = 64;

}  // namespace

void StopCoordinator::ask(std::string by, std::string reason, std::int64_t seq, std::int8_t clear,
                          std::int64_t now) {
  robot_stop_t request{};
  request.seq = seq;
  request.clear = clear;
  request.reason = std::move(reason);
  begin(request, std::move(by), true, now);
}

void StopCoordinator::begin(const robot_stop_t& request, std::string by, bool own,
                            std::int64_t now) {
  known_.push_back(request.seq);
  if (known_.size() > kMostKnown) known_.pop_front();
  asked_ = true;
  own_ = own;
  adopted_ = false;
  by_ = std::move(by);
  request_ = request;
  begun_utime_ = now;
  sent_utime_ = 0;
  response_time_us_.reset();
  for (auto& [robot, obeys] : obeys_) obeys = false;
}

void StopCoordinator::take(const robot_stop_t& stop, std::int64_t now) {
  if (std::ranges::find(known_, stop.seq) != known_.end()) return;
  begin(stop, stop.sender, false, now);
}

void StopCoordinator::take(const robot_status_t& status, std::int64_t now) {
  if (!asked_) adopt(status, now);
  for (const robot_state_t& robot : status.robots) {
    if (robot.origin == robot_state_t::REPLAY) {
      obeys_.erase(robot.robot_id);
      continue;
    }
    obeys_[robot.robot_id] = isObeyedBy(robot);
  }
  if (!response_time_us_ && !adopted_ && confirmed()) response_time_us_ = now - begun_utime_;
  const auto obeys = [](const auto& robot) { return robot.second; };
  if (adopted_ && std::ranges::none_of(obeys_, obeys)) asked_ = adopted_ = false;  // it is over
}

void StopCoordinator::adopt(const robot_status_t& status, std::int64_t now) {
  for (const robot_state_t& robot : status.robots) {
    const bool stopped = (robot.flags & robot_state_t::FLAG_STOPPED) != 0;
    if (!stopped || robot.origin == robot_state_t::REPLAY) continue;
    robot_stop_t request{};
    request.seq = robot.stop_seq;
    begin(request, "", false, now);
    // Its repetition is the first that is heard of it: who asked, and why.
    known_.pop_back();
    adopted_ = true;
    return;
  }
}

void StopCoordinator::newRun() {
  if (!own_ || state() == State::kFree) {
    *this = StopCoordinator();
  } else {
    obeys_.clear();
  }
}

bool StopCoordinator::isObeyedBy(const robot_state_t& robot) const {
  const bool stopped = (robot.flags & robot_state_t::FLAG_STOPPED) != 0;
  if (!asked_) return false;
  // A robot that came later has never been stopped and is free as wanted.
  if (request_.clear != 0) return !stopped;
  return stopped && (adopted_ || robot.stop_seq == request_.seq);
}

bool StopCoordinator::isAsked(std::int32_t robot) const {
  const auto& ids = request_.robot_ids;
  return ids.empty() || std::ranges::find(ids, robot) != ids.end();
}

std::vector<std::int32_t> StopCoordinator::unconfirmed() const {
  std::vector<std::int32_t> ids;
  if (!asked_) return ids;
  for (const auto& [robot, obeys] : obeys_) {
    if (!obeys && isAsked(robot)) ids.push_back(robot);
  }
  return ids;
}

std::size_t StopCoordinator::total() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(obeys_, [this](const auto& robot) { return isAsked(robot.first); }));
}

bool StopCoordinator::confirmed() const { return asked_ && total() > 0 && unconfirmed().empty(); }

StopCoordinator::State StopCoordinator::state() const {
  if (!asked_) return State::kFree;
  if (request_.clear != 0) return confirmed() ? State::kFree : State::kReleasing;
  return confirmed() ? State::kStopped : State::kStopping;
}

std::optional<robot_stop_t> StopCoordinator::due(std::int64_t now) {
  const bool young = now - begun_utime_ < kDiscovery_us;
  if (!asked_ || !own_ || (confirmed() && !young)) return std::nullopt;
  const bool may_tire = request_.clear != 0 || total() == 0;
  if (may_tire && now - begun_utime_ > kTimeout_us) return std::nullopt;
  if (sent_utime_ != 0 && now - sent_utime_ < kRepeat_us) return std::nullopt;
  sent_utime_ = now;
  request_.utime = now;
  return request_;
}

}  // namespace lab
