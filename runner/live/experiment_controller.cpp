#include "runner/live/experiment_controller.hpp"

#include <algorithm>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/fingerprints.hpp"
#include "common/calibration/light_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/experiment/script_plan.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/files/file_text.hpp"
#include "common/math/units.hpp"
#include "common/process/version.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kRobotPeriod_us = 200'000;  // 5 Hz
constexpr std::int64_t kHandshakePeriod_us = 20'000;
constexpr std::int64_t kStopPeriod_us = 100'000;  // 10 Hz
// Then the script starts without those that are missing. A board on a serial line needs 1.3 s for
// its bootloader, up to 2.5 s until it is spoken to, and a second for its table.
constexpr std::int64_t kLightEchoPatience_us = 3'000'000;
constexpr std::int64_t kSerialEchoPatience_us = 10'000'000;
constexpr std::int64_t kLightPatience_us = 2'000'000;
// The network may lose one message; what happens once is said more than once.
constexpr int kRepeatEvent = 3;
constexpr std::int64_t kStartEvery_us = 60'000'000;
constexpr std::int64_t kStatusPeriod_us = 500'000;  // 2 Hz

bool waitsForEstimates(const Experiment& experiment) {
  return !experiment.stop_when.empty() ||
         std::ranges::any_of(experiment.light.steps,
                             [](const LightStep& step) { return !step.until.estimate.empty(); });
}

std::string ownerName(const std::string& sender, std::int64_t instance) {
  return sender + " (instance " + std::to_string(instance) + ")";
}

}  // namespace

ExperimentController::ExperimentController(const ServiceContext& context, std::string effective,
                                           std::function<void(Ending, const std::string&)> over)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      run_(context.directory.filename().string()),
      effective_(std::move(effective)),
      over_(std::move(over)),
      request_log_([this](const experiment_command_t& wish) { return obey(wish); }),
      robots_(lightTableCommand(context.experiment)),
      handshake_(context.experiment),
      light_(context.node, context.loop, context.experiment, context.directory,
             {.record = [this](const experiment_event_t& event) { record(event); },
              .fault = [this](const std::string& what) { fault(what); },
              .shown = [this] { lightShown(); },
              .began = [this] { sendStatus(); },
              .chosen_by_light =
                  [this] {
                    return !robots_.orders.empty() &&
                           robots_.orders.front().mode == robot_order_t::TABLE;
                  },
              .end = [this](const ScriptTransition& turn) { endScript(turn); }}),
      stop_rules_(context.experiment) {
  // The experiment's bands are light on the arena; robots compare what their sensors read.
  if (const auto calibration = activeLightCalibration(experiment_, context.directory)) {
    robots_ = withCalibratedBands(robots_, *calibration);
    light_calibration_ =
        readFileText((context.directory / experiment_.projector.light_calibration).string());
  }
  node_.subscribe<robot_status_t>(channels::kRobotStatus,
                                  [this](const robot_status_t& status) { take(status); });
  node_.subscribe<tracked_frame_t>(channels::kTrackedFrame,
                                   [this](const tracked_frame_t& frame) { take(frame); });
  node_.subscribe<service_status_t>(channels::kServiceStatus,
                                    [this](const service_status_t& status) { take(status); });
  node_.subscribe<robot_stop_t>(channels::kRobotStop,
                                [this](const robot_stop_t& stop) { take(stop); });
  node_.subscribe<robot_command_t>(channels::kRobotCommand,
                                   [this](const robot_command_t& command) { take(command); });
  node_.subscribe<experiment_command_t>(channels::kExperimentCommand,
                                        [this](const experiment_command_t& wish) { take(wish); });
  if (waitsForEstimates(experiment_)) {
    node_.subscribe<analysis_t>(channels::kAnalysis,
                                [this](const analysis_t& analysis) { take(analysis); });
  }
}

void ExperimentController::begin() {
  const std::int64_t now = loop_.now();
  announceStart();
  loop_.every(kStartEvery_us, now + kStartEvery_us, [this] {
    if (phase_ != Phase::kConcluded) announceStart();
  });
  if (handshake_.needed()) {
    phase_ = Phase::kHandshake;
    after_handshake_ = robots_;
    light_.showEverywhere(1, "handshake");
    loop_.every(kHandshakePeriod_us, now, [this] { shakeHands(); });
  } else {
    askRobots();
  }
  loop_.every(kRobotPeriod_us, now, [this] { sendRobots(); });
  light_.begin();
  loop_.every(kStopPeriod_us, now, [this] { repeatStops(); });
  loop_.every(kStatusPeriod_us, now, [this] { sendStatus(); });
}

void ExperimentController::shakeHands() {
  if (phase_ != Phase::kHandshake) return;
  const bool another =
      handshake_.advance(loop_.now(), [this](std::int32_t id) { return isObeyedBy(id); });
  if (another) command(handshake_.command());
  if (!handshake_.done()) return;
  for (const std::int32_t id : handshake_.unknown()) {
    fault("robot " + std::to_string(id) +
          " was told to turn, and the tracker saw no cap that did: is it under the camera, does it "
          "drive?");
  }
  dim();
}

/// No robot is to see the light of the handshake with a light table in its hands.
void ExperimentController::dim() {
  phase_ = Phase::kDimming;
  command(standCommand(experiment_));
  light_.showEverywhere(experiment_.light.safe_intensity, "after the handshake");
  loop_.at(loop_.now() + kLightPatience_us, [this] {
    if (phase_ == Phase::kDimming) askRobots();
  });
}

void ExperimentController::lightShown() {
  if (phase_ == Phase::kDimming) askRobots();
  if (phase_ == Phase::kLeaving) {
    safe_light_ = true;
    leave();
  }
}

void ExperimentController::askRobots() {
  const bool after = phase_ == Phase::kDimming;
  phase_ = Phase::kAskingRobots;
  if (after) {
    command(after_handshake_);
  } else {
    ++robots_.seq;
  }
  const bool on_wire = std::ranges::any_of(
      experiment_.robots, [](const RobotSpec& robot) { return isOnWire(robot.body); });
  const std::int64_t patience = on_wire ? kSerialEchoPatience_us : kLightEchoPatience_us;
  loop_.at(loop_.now() + patience, [this, patience] {
    if (phase_ != Phase::kAskingRobots) return;
    fault("robots that did not take their light table within " +
          std::to_string(patience / units::kSecond_us) + " s: " + silentRobots() +
          "; the script starts without them");
    startScript();
  });
}

void ExperimentController::announceStart() {
  experiment_event_t event{};
  event.kind = experiment_event_t::START;
  event.text = effective_;
  event.contract_version = kContractVersion;
  event.fingerprints = fingerprintList();
  event.version = kVersion;
  record(std::move(event));
  if (light_calibration_.empty()) return;
  experiment_event_t calibration{};
  calibration.kind = experiment_event_t::CALIBRATION;
  calibration.label = "light";
  calibration.text = light_calibration_;
  record(std::move(calibration));
}

void ExperimentController::record(experiment_event_t event) {
  event.utime = loop_.now();
  for (int copy = 0; copy < kRepeatEvent; ++copy) {
    node_.publish(channels::kExperimentEvent, event);
  }
}

void ExperimentController::fault(const std::string& what) {
  faults_.push_back(what);
  node_.noteError(what);
  experiment_event_t event{};
  event.kind = experiment_event_t::FAULT;
  event.text = what;
  record(std::move(event));
}

void ExperimentController::mark(const std::string& what) {
  experiment_event_t event{};
  event.kind = experiment_event_t::MARK;
  event.text = what;
  record(std::move(event));
}

void ExperimentController::sendRobots() {
  if (phase_ == Phase::kIdle) return;
  // A robot that has just booted hears of a stop before it hears of anything else.
  repeatStops();
  robot_command_t command = yielded_.without(robots_, loop_.now());
  command.utime = 0;
  node_.publishCommand(channels::kRobotCommand, command);
}

void ExperimentController::command(robot_command_t command) {
  command.seq = robots_.seq + 1;
  robots_ = std::move(command);
  sendRobots();
}

void ExperimentController::startScript() {
  phase_ = Phase::kScript;
  stop_rules_.begin(loop_.now());
  light_.startScript();
}

void ExperimentController::endScript(const ScriptTransition& turn) {
  if (phase_ != Phase::kScript || stop_reached_) return;
  if (turn.kind == ScriptTransition::Kind::kOver && stop_rules_.given()) {
    // They would have ended the run before.
    const std::string unmet = stop_rules_.unmet();
    fault(unmet);
    over_(Ending::kUnmet, unmet);
  } else if (turn.kind == ScriptTransition::Kind::kOver) {
    over_(Ending::kDone,
          "the script is over" + (turn.ended_by.empty() ? "" : ": " + turn.ended_by));
  } else if (turn.kind == ScriptTransition::Kind::kEnd) {
    over_(Ending::kUnmet, turn.fault);
  } else {
    phase_ = Phase::kLeaving;
    ended_ = light_.script().elapsed(loop_.now());
    leaving_because_ = turn.fault;
    command(standCommand(experiment_));
    light_.showEverywhere(experiment_.light.safe_intensity, "safe");
    sendStatus();
    loop_.at(loop_.now() + kLightPatience_us, [this] {
      if (phase_ == Phase::kLeaving) over_(Ending::kUnmet, leaving_because_);
    });
  }
}

/// The run ends when the safe light is on the arena and every robot stands, or when that takes
/// long.
void ExperimentController::leave() {
  if (phase_ == Phase::kLeaving && safe_light_ && allEchoed()) {
    over_(Ending::kUnmet, leaving_because_);
  }
}

void ExperimentController::take(const robot_status_t& status) {
  checkOwner(status);
  for (const robot_state_t& robot : status.robots) states_[robot.robot_id] = robot;
  if (phase_ == Phase::kAskingRobots && allEchoed()) startScript();
  light_.take(status);
  leave();
}

bool ExperimentController::hasEchoed(const RobotSpec& robot) const {
  const bool takes_none = robot.body == Body::kReplay;  // a recorded one takes no orders
  const bool table = !robots_.orders.empty() && robots_.orders.front().mode == robot_order_t::TABLE;
  return takes_none || isObeyedBy(robot.id) || (table && yielded_.contains(robot.id, loop_.now()));
}

bool ExperimentController::isObeyedBy(std::int32_t robot_id) const {
  const auto state = states_.find(robot_id);
  return state != states_.end() && state->second.command_seq == robots_.seq &&
         state->second.command_instance == node_.identity().instance;
}

bool ExperimentController::allEchoed() const {
  return std::ranges::all_of(experiment_.robots,
                             [this](const RobotSpec& robot) { return hasEchoed(robot); });
}

std::string ExperimentController::silentRobots() const {
  std::string ids;
  for (const RobotSpec& robot : experiment_.robots) {
    if (!hasEchoed(robot)) ids += (ids.empty() ? "" : ", ") + std::to_string(robot.id);
  }
  return ids;
}

void ExperimentController::checkOwner(const robot_status_t& status) {
  for (const robot_state_t& robot : status.robots) {
    Owner& owner = owners_[robot.robot_id];
    const bool same = owner.sender == status.sender && owner.instance == status.instance;
    const bool other_is_alive =
        !owner.sender.empty() && status.utime - owner.utime < units::kSecond_us;
    // A restarted service takes its robots over; only two that speak at once are in dispute. An
    // older instance of the same service is on its way out.
    const bool takes_over = owner.sender == status.sender && status.instance > owner.instance;
    if (!same && other_is_alive && !takes_over) {
      if (disputed_.insert(robot.robot_id).second) {
        const std::string what = "robot " + std::to_string(robot.robot_id) + " has two owners, " +
                                 ownerName(owner.sender, owner.instance) + " and " +
                                 ownerName(status.sender, status.instance) +
                                 ": stop one of them or give its robot another id";
        fault(what);
        over_(Ending::kBroken, what);
      }
      continue;
    }
    owner = {status.sender, status.instance, status.utime};
  }
}

void ExperimentController::take(const tracked_frame_t& frame) {
  if (phase_ == Phase::kHandshake) handshake_.see(frame);
  for (const tracked_pose_t& pose : frame.robots) {
    poses_[pose.robot_id] = pose;
    seen_utime_[pose.robot_id] = frame.utime;
  }
  light_.take(frame);
}

void ExperimentController::take(const robot_stop_t& stop) {
  const bool own = stop.sender == node_.identity().name;
  if (own || phase_ == Phase::kIdle || !stops_heard_.insert(stop.seq).second) return;
  latch(stop);
  mark(std::string(stop.clear != 0 ? "stop released by " : "robots stopped by ") + stop.sender +
       (stop.reason.empty() ? "" : ": " + stop.reason));
}

void ExperimentController::take(const robot_command_t& command) {
  if (command.sender != node_.identity().name) yielded_.take(command, loop_.now());
}

void ExperimentController::take(const analysis_t& analysis) {
  if (phase_ == Phase::kScript) {
    stop_rules_.take(analysis);
    const auto why = stop_rules_.met();
    if (why && !stop_reached_) {
      stop_reached_ = true;
      over_(Ending::kDone, *why);
    }
  }
  // A script that the same message ends has nothing to say any more.
  if (!stop_reached_) light_.take(analysis);
}

void ExperimentController::take(const service_status_t& status) {
  const bool own = status.sender == node_.identity().name;
  if (own || phase_ == Phase::kIdle || status.last_error.empty()) return;
  if (!complaints_.insert(status.sender + ": " + status.last_error).second) return;
  const std::string what = status.sender + ": " + status.last_error;
  status.sender == kObserverService ? mark(what) : fault(what);
}

void ExperimentController::latch(const robot_stop_t& stop) {
  std::vector<std::int32_t> ids = stop.robot_ids;
  if (ids.empty()) {
    for (const RobotSpec& robot : experiment_.robots) ids.push_back(robot.id);
  }
  for (const std::int32_t id : ids) {
    if (stop.clear != 0) {
      latched_.erase(id);
    } else {
      latched_[id] = stop.seq;
    }
  }
}

void ExperimentController::repeatStops() {
  std::map<std::int64_t, robot_stop_t> by_seq;
  for (const auto& [id, seq] : latched_) {
    robot_stop_t& stop = by_seq[seq];
    stop.seq = seq;
    stop.utime = loop_.now();
    stop.clear = 0;
    stop.reason = "stop in force";
    stop.robot_ids.push_back(id);
    stop.num_robots = static_cast<std::int32_t>(stop.robot_ids.size());
  }
  for (auto& [seq, stop] : by_seq) node_.publishCommand(channels::kRobotStop, stop);
}

void ExperimentController::stopRobots(const std::string& why) {
  robot_stop_t stop{};
  stop.seq = loop_.now();
  stop.utime = stop.seq;
  stop.reason = why;
  latch(stop);
  node_.publishCommand(channels::kRobotStop, stop);
}

void ExperimentController::conclude(const std::string& why) {
  if (phase_ == Phase::kConcluded) return;
  light_.close();
  if (phase_ == Phase::kScript) ended_ = light_.script().elapsed(loop_.now());
  phase_ = Phase::kConcluded;
  command(standCommand(experiment_));
  experiment_event_t event{};
  event.kind = experiment_event_t::END;
  event.text = why;
  record(std::move(event));
  for (int copy = 0; copy < kRepeatEvent; ++copy) sendStatus();
}

Progress ExperimentController::progress() const {
  Progress progress;
  const std::int64_t now = loop_.now();
  if (phase_ == Phase::kScript) progress.elapsed = light_.script().elapsed(now);
  if (phase_ == Phase::kConcluded || phase_ == Phase::kLeaving) progress.elapsed = ended_;
  progress.left = std::max(0.0, experiment_.duration - progress.elapsed);
  progress.at_most = mayEndEarly(experiment_);
  progress.paused = phase_ == Phase::kScript && light_.script().paused();
  if (phase_ == Phase::kScript) progress.stop = stop_rules_.progress();
  progress.light = light_.label();
  progress.robots_seen = static_cast<std::size_t>(
      std::count_if(seen_utime_.begin(), seen_utime_.end(),
                    [now](const auto& seen) { return now - seen.second < units::kSecond_us; }));
  for (const auto& [id, state] : states_) {
    ++progress.robots_running[programName(experiment_, state.program)];
  }
  progress.lost = node_.streams().lost();
  return progress;
}

}  // namespace lab::runner
