#include "dashboard/control/controls.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/experiment/light_messages.hpp"
#include "common/math/units.hpp"
#include "dashboard/views/timeline_view.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace {

constexpr std::int64_t kExperimentSilent_us = 3'000'000;
constexpr double kMaxHold = 86400;  // [s]
constexpr double kMaxSpeed = 1000;  // [1] seconds of the log per second
constexpr const char* kLightLabel = "by hand, from the page";
constexpr const char* kNoLiveRobots = "the robots of a replayed log cannot be commanded";

const char* stateName(StopCoordinator::State state) {
  switch (state) {
    case StopCoordinator::State::kFree:
      return "free";
    case StopCoordinator::State::kStopping:
      return "stopping";
    case StopCoordinator::State::kStopped:
      return "stopped";
    case StopCoordinator::State::kReleasing:
      return "releasing";
  }
  return "";
}

template <class... Cases>
struct Match : Cases... {
  using Cases::operator()...;
};
// Needed by clang before version 17.
template <class... Cases>
Match(Cases...) -> Match<Cases...>;

}  // namespace

std::int64_t Controls::nextSeq(std::int64_t now) {
  seq_ = std::max(seq_ + 1, now);
  return seq_;
}

std::string Controls::request(const OperatorRequest& request, std::int64_t now) {
  using Command = experiment_command_t;
  return std::visit(
      Match{
          [&](const StopRobots& stop) -> std::string {
            if (replay_) return kNoLiveRobots;
            const std::string problem = remarkProblem(stop.reason);
            // An invalid reason must not prevent the stop.
            stop_.stop(sender_,
                       stop.reason.empty() || !problem.empty() ? "from the page" : stop.reason,
                       nextSeq(now), now);
            return {};
          },
          [&](const ReleaseStop&) -> std::string {
            if (replay_) return kNoLiveRobots;
            stop_.release(sender_, "from the page", nextSeq(now), now);
            return {};
          },
          [&](const PauseScript&) { return queue("pause", Command::PAUSE, 0, "", false, now); },
          [&](const ResumeScript&) { return queue("resume", Command::RESUME, 0, "", false, now); },
          [&](const MarkRun& mark) {
            return queue("mark", Command::MARK, 0, mark.text, false, now);
          },
          [&](const EndRun& end) { return queue("end", Command::END, 0, end.why, false, now); },
          [&](const ShowLight& light) { return showLight(light, now); },
          [&](const ReleaseLight&) -> std::string {
            if (!light_.isShown()) return "this page does not control the light";
            light_.release();
            waitForLight("release_light", now);
            return {};
          },
          [&](const SeekLog& seek) -> std::string {
            if (!std::isfinite(seek.to) || seek.to < 0)
              return "to_s: expected a time of at least 0";
            return queue("seek", Command::SEEK, seek.to, "", true, now);
          },
          [&](const SpeedLog& speed) -> std::string {
            if (!(speed.speed > 0) || speed.speed > kMaxSpeed) {
              return "speed: expected more than 0 and at most 1000";
            }
            return queue("speed", Command::SPEED, speed.speed, "", true, now);
          }},
      request);
}

std::string Controls::showLight(const ShowLight& light, std::int64_t now) {
  if (replay_) return "the light of a replayed log cannot be changed";
  if (!(light.intensity >= 0) || light.intensity > 1) return "intensity: expected 0 to 1";
  if (!(light.hold >= 0) || light.hold > kMaxHold) return "hold_s: expected 0 to 86400";
  light_.show(light.intensity, light.hold, kLightLabel, now);
  waitForLight("light", now);
  return {};
}

void Controls::waitForLight(const char* name, std::int64_t now) {
  pending_light_request_ = name;
  light_utime_ = now;
  light_refusal_.clear();
}

std::string Controls::queue(const char* name, std::int8_t action, double value,
                            const std::string& text, bool needs_log, std::int64_t now) {
  if (status_utime_ == 0 || now - status_utime_ > kExperimentSilent_us) {
    return needs_log ? "no log is being replayed on this bus" : "no run is active on this bus";
  }
  if (needs_log && !replay_) return "this is a running lab, not a replayed log";
  const bool needs_live_run =
      action == experiment_command_t::MARK || action == experiment_command_t::END;
  if (needs_live_run && replay_) return "a replayed log is finished and takes no remarks";
  if (const std::string problem = remarkProblem(text); !problem.empty()) return problem;
  if (pending_requests_.size() >= kMaxPending) return "too many requests are pending";
  experiment_command_t command{};
  command.action = action;
  command.value = value;
  command.text = text;
  pending_requests_.push_back({{command, sender_, instance_, nextSeq(now), now}, name});
  return {};
}

void Controls::take(const robot_stop_t& stop, std::int64_t now) {
  if (stop.sender == sender_ && stop.instance == instance_) return;
  stop_.take(stop, now);
}

void Controls::take(const experiment_status_t& status, std::int64_t now) {
  status_utime_ = now;
  replay_ = isPlayed(status);
  if (pending_requests_.empty() || !pending_requests_.front().request.take(status)) return;
  const PendingRequest& pending = pending_requests_.front();
  const std::string& refusal = pending.request.refusal();
  setNote(pending.name, refusal.empty() ? "done" : "refused: " + refusal, now);
  pending_requests_.pop_front();
  sent_utime_ = 0;
}

void Controls::take(const light_status_t& status, std::int64_t now) {
  if (pending_light_request_.empty()) return;
  const std::string refusal = parseRefusal(sender_, light_.seq(), status.last_refusal);
  if (!refusal.empty()) light_refusal_ = refusal;
  const bool ours = status.commander == sender_ && status.command_instance == instance_;
  if (ours != light_.isShown() || status.utime < light_utime_) return;
  setNote(pending_light_request_, light_.isShown() ? "shown" : "the script's light is shown again",
          now);
  pending_light_request_.clear();
}

void Controls::expect(const std::vector<std::int32_t>& commanded_robots) {
  for (const std::int32_t robot : commanded_robots) stop_.expect(robot);
}

void Controls::beginRun() {
  stop_.newRun();
  pending_requests_.clear();
  sent_utime_ = 0;
}

DueCommands Controls::due(std::int64_t now) {
  DueCommands due;
  due.stop = stop_.due(now);
  due.light = light_.due(now);
  if (!pending_light_request_.empty() && now - light_utime_ > kLightTimeout_us) {
    setNote(
        pending_light_request_,
        "the projector does not show it" + (light_refusal_.empty() ? "" : ": " + light_refusal_),
        now);
    pending_light_request_.clear();
  }
  if (pending_requests_.empty()) return due;
  // Its timeout begins when it becomes the first.
  if (sent_utime_ == 0) {
    const experiment_command_t& message = pending_requests_.front().request.message();
    pending_requests_.front().request = {message, sender_, instance_, message.seq, now};
  }
  const PendingRequest& pending = pending_requests_.front();
  if (pending.request.expired(now)) {
    setNote(pending.name, "no answer within 5 s", now);
    pending_requests_.pop_front();
    sent_utime_ = 0;
    return due;
  }
  if (sent_utime_ != 0 && now - sent_utime_ < ExperimentRequest::kRepeat_us) return due;
  sent_utime_ = now;
  due.experiment = pending.request.message();
  return due;
}

void Controls::setNote(const std::string& name, const std::string& text, std::int64_t now) {
  note_ = toText({{"t_us", now}, {"request", name}, {"text", text}});
}

std::string Controls::stopJson() const {
  const std::vector<std::int32_t> missing = stop_.unconfirmed();
  Json took;
  if (const auto took_us = stop_.responseTime()) took = number(units::seconds(*took_us) * 1e3);
  return toText({{"state", stateName(stop_.state())},
                 {"by", stop_.by()},
                 {"reason", stop_.reason()},
                 {"total", stop_.total()},
                 {"confirmed", stop_.total() - missing.size()},
                 {"unconfirmed", missing},
                 {"took_ms", std::move(took)}});
}

}  // namespace lab::dashboard
