#include "dashboard/control/controls.hpp"

#include <algorithm>
#include <cmath>

#include "common/experiment/light_messages.hpp"
#include "common/math/units.hpp"
#include "dashboard/views/json.hpp"
#include "dashboard/views/timeline_view.hpp"

namespace lab::dashboard {
namespace {

constexpr std::int64_t kConductorSilent_us = 3'000'000;
constexpr double kLongestHold = 86400;  // [s]
constexpr double kFastest = 1000;       // [1] log seconds a second
constexpr const char* kLightLabel = "by hand, from the page";
constexpr const char* kNoRobotHears = "the robots of a played log do not obey";

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

}  // namespace

std::int64_t Controls::nextSeq(std::int64_t now) {
  seq_ = std::max(seq_ + 1, now);
  return seq_;
}

std::string Controls::wish(const OperatorRequest& wish, std::int64_t now) {
  using Command = experiment_command_t;
  return std::visit(
      Match{[&](const StopRobots& w) -> std::string {
              if (replay_) return kNoRobotHears;
              const std::string problem = remarkProblem(w.reason);
              // What is wrong with the words is no reason not to stop.
              stop_.stop(sender_, w.reason.empty() || !problem.empty() ? "from the page" : w.reason,
                         nextSeq(now), now);
              return {};
            },
            [&](const ReleaseStop&) -> std::string {
              if (replay_) return kNoRobotHears;
              stop_.release(sender_, "from the page", nextSeq(now), now);
              return {};
            },
            [&](const PauseScript&) { return ask("pause", Command::PAUSE, 0, "", false, now); },
            [&](const ResumeScript&) { return ask("resume", Command::RESUME, 0, "", false, now); },
            [&](const MarkRun& w) { return ask("mark", Command::MARK, 0, w.text, false, now); },
            [&](const EndRun& w) { return ask("end", Command::END, 0, w.why, false, now); },
            [&](const ShowLight& w) { return act(w, now); },
            [&](const ReleaseLight&) -> std::string {
              if (!light_.isShown()) return "no light is set from here";
              light_.release();
              watchLight("release_light", now);
              return {};
            },
            [&](const SeekLog& w) -> std::string {
              if (!std::isfinite(w.to) || w.to < 0) return "to_s: a time from 0 on is wanted";
              return ask("seek", Command::SEEK, w.to, "", true, now);
            },
            [&](const SpeedLog& w) -> std::string {
              if (!(w.speed > 0) || w.speed > kFastest) {
                return "speed: more than 0 and at most 1000 is wanted";
              }
              return ask("speed", Command::SPEED, w.speed, "", true, now);
            }},
      wish);
}

std::string Controls::act(const ShowLight& light, std::int64_t now) {
  if (replay_) return "the light of a played log is what it was";
  if (!(light.intensity >= 0) || light.intensity > 1) return "intensity: 0 to 1 is wanted";
  if (!(light.hold >= 0) || light.hold > kLongestHold) return "hold_s: 0 to 86400 is wanted";
  light_.show(light.intensity, light.hold, kLightLabel, now);
  watchLight("light", now);
  return {};
}

void Controls::watchLight(const char* name, std::int64_t now) {
  pending_light_request_ = name;
  light_utime_ = now;
  light_refusal_.clear();
}

std::string Controls::ask(const char* name, std::int8_t action, double value,
                          const std::string& text, bool of_a_log, std::int64_t now) {
  if (heard_utime_ == 0 || now - heard_utime_ > kConductorSilent_us) {
    return of_a_log ? "no log is played on this bus" : "no run is conducted on this bus";
  }
  if (of_a_log && !replay_) return "this is a running lab, no played log";
  const bool only_of_a_lab =
      action == experiment_command_t::MARK || action == experiment_command_t::END;
  if (only_of_a_lab && replay_) return "a played log has been recorded: it takes no remarks";
  if (const std::string problem = remarkProblem(text); !problem.empty()) return problem;
  if (pending_requests_.size() >= kMostWaiting) return "too many wishes wait for an answer";
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
  heard_utime_ = now;
  replay_ = isPlayed(status);
  if (pending_requests_.empty() || !pending_requests_.front().request.take(status)) return;
  const PendingRequest& errand = pending_requests_.front();
  const std::string& refusal = errand.request.refusal();
  note(errand.name, refusal.empty() ? "done" : "refused: " + refusal, now);
  pending_requests_.pop_front();
  sent_utime_ = 0;
}

void Controls::take(const light_status_t& status, std::int64_t now) {
  if (pending_light_request_.empty()) return;
  const std::string refusal = parseRefusal(sender_, light_.seq(), status.last_refusal);
  if (!refusal.empty()) light_refusal_ = refusal;
  const bool ours = status.commander == sender_ && status.command_instance == instance_;
  if (ours != light_.isShown() || status.utime < light_utime_) return;
  note(pending_light_request_, light_.isShown() ? "shown" : "the script's light is back", now);
  pending_light_request_.clear();
}

void Controls::expect(const std::vector<std::int32_t>& commanded_robots) {
  for (const std::int32_t robot : commanded_robots) stop_.expect(robot);
}

void Controls::forget() {
  stop_.newRun();
  pending_requests_.clear();
  sent_utime_ = 0;
}

DueCommands Controls::due(std::int64_t now) {
  DueCommands due;
  due.stop = stop_.due(now);
  due.light = light_.due(now);
  if (!pending_light_request_.empty() && now - light_utime_ > kLightTimeout_us) {
    note(pending_light_request_,
         "the projector does not show it" + (light_refusal_.empty() ? "" : ": " + light_refusal_),
         now);
    pending_light_request_.clear();
  }
  if (pending_requests_.empty()) return due;
  // Its patience begins when it is its turn.
  if (sent_utime_ == 0) {
    const experiment_command_t& message = pending_requests_.front().request.message();
    pending_requests_.front().request = {message, sender_, instance_, message.seq, now};
  }
  const PendingRequest& errand = pending_requests_.front();
  if (errand.request.expired(now)) {
    note(errand.name, "nobody has answered for 5 s", now);
    pending_requests_.pop_front();
    sent_utime_ = 0;
    return due;
  }
  if (sent_utime_ != 0 && now - sent_utime_ < ExperimentRequest::kRepeat_us) return due;
  sent_utime_ = now;
  due.experiment = errand.request.message();
  return due;
}

void Controls::note(const std::string& wish, const std::string& text, std::int64_t now) {
  note_ = toText({{"t_us", now}, {"wish", wish}, {"text", text}});
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
