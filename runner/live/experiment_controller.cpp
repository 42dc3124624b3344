#include "runner/live/experiment_controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/calibration/light_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/experiment/script_plan.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/files/file_text.hpp"
#include "common/math/units.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kRobotPeriod_us = 200'000;  // 5 Hz
constexpr std::int64_t kHandshakePeriod_us = 20'000;
constexpr std::int64_t kStopPeriod_us = 100'000;  // 10 Hz
// After this time the script starts without the robots that have not echoed their table. A board on
// a serial line needs 1.3 s for its bootloader, up to 2.5 s until robot_bridge opens the line, and
// 1 s for its table.
constexpr std::int64_t kLightEchoTimeout_us = 3'000'000;
constexpr std::int64_t kSerialEchoTimeout_us = 10'000'000;
constexpr std::int64_t kLightTimeout_us = 2'000'000;
constexpr std::int64_t kStartEvery_us = 60'000'000;
constexpr std::int64_t kStatusPeriod_us = 500'000;  // 2 Hz
// Bounds for what others publish, far above what operators and programs need.
constexpr std::size_t kMostOtherRobots = 1000;
constexpr int kMostRequests = 200;  // in kLimitPeriod_us, as the next
constexpr int kMostAnswers = 500;
constexpr std::int64_t kLimitPeriod_us = 10'000'000;

constexpr const char* kAnalyzer = "analyzer";

}  // namespace

ExperimentController::ExperimentController(const ServiceContext& context, std::string effective,
                                           std::function<void(Ending, const std::string&)> over)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      run_(context.directory.filename().string()),
      over_(std::move(over)),
      request_log_([this](const experiment_command_t& request) { return execute(request); }),
      record_(context.node, context.loop, std::move(effective)),
      robots_(lightTableCommand(context.experiment)),
      handshake_(context.experiment),
      light_(context.node, context.loop, context.experiment, context.directory,
             {.record = [this](const experiment_event_t& event) { record_.write(event); },
              .fault = [this](const std::string& what) { fault(what); },
              .shown = [this] { lightShown(); },
              .began = [this] { sendStatus(); },
              .chosen_by_light =
                  [this] {
                    return !robots_.orders.empty() &&
                           robots_.orders.front().mode == robot_order_t::TABLE;
                  },
              .end = [this](const ScriptTransition& transition) { endScript(transition); }}),
      stop_rules_(context.experiment),
      senses_(context),
      stops_(context.node, context.loop, context.experiment, record_),
      admission_(context.experiment, kMostOtherRobots),
      requests_(kMostRequests, kLimitPeriod_us),
      answers_(kMostAnswers, kLimitPeriod_us) {
  // The experiment's bands are intensities on the arena. Robots compare their sensor readings, so
  // the calibration converts the bands.
  if (const auto calibration = activeLightCalibration(experiment_, context.directory)) {
    robots_ = withCalibratedBands(robots_, *calibration);
    record_.setLightCalibration(readFileText(
        context.directory / experiment_.projector.light_calibration, file_kinds::kCalibration));
  }
  node_.subscribe<robot_status_t>(channels::kRobotStatus, [this](const robot_status_t& status) {
    const auto admitted = admission_.withoutRefused(status);
    take(admitted ? *admitted : status);
    reportRefused();
  });
  node_.subscribe<tracked_frame_t>(channels::kTrackedFrame, [this](const tracked_frame_t& frame) {
    const auto admitted = admission_.withoutRefused(frame);
    take(admitted ? *admitted : frame);
    reportRefused();
  });
  node_.subscribe<service_status_t>(channels::kServiceStatus,
                                    [this](const service_status_t& status) { take(status); });
  node_.subscribe<robot_stop_t>(channels::kRobotStop, [this](const robot_stop_t& stop) {
    const bool own = stop.sender == node_.identity().name;
    if (!own && phase_ != Phase::kIdle) stops_.take(stop);
  });
  node_.subscribe<robot_command_t>(channels::kRobotCommand,
                                   [this](const robot_command_t& command) { take(command); });
  node_.subscribe<experiment_command_t>(
      channels::kExperimentCommand, [this](const experiment_command_t& request) { take(request); });
  if (waitsForEstimates(experiment_)) {
    node_.subscribe<analysis_t>(channels::kAnalysis,
                                [this](const analysis_t& analysis) { take(analysis); });
  }
  if (needsCrowd(experiment_)) {
    node_.subscribe<collective_t>(channels::kCollective,
                                  [this](const collective_t& message) { take(message); });
  }
}

void ExperimentController::begin() {
  const std::int64_t now = loop_.now();
  record_.start();
  loop_.every(kStartEvery_us, now + kStartEvery_us, [this] {
    if (phase_ != Phase::kConcluded) record_.start();
  });
  if (handshake_.needed()) {
    phase_ = Phase::kHandshake;
    after_handshake_ = robots_;
    light_.showEverywhere(1, "handshake");
    loop_.every(kHandshakePeriod_us, now, [this] { continueHandshake(); });
  } else {
    askRobots();
  }
  loop_.every(kRobotPeriod_us, now, [this] { sendRobots(); });
  light_.begin();
  loop_.every(kStopPeriod_us, now, [this] { stops_.repeat(); });
  loop_.every(kStatusPeriod_us, now, [this] { sendStatus(); });
}

void ExperimentController::continueHandshake() {
  if (phase_ != Phase::kHandshake) return;
  const bool another =
      handshake_.advance(loop_.now(), [this](std::int32_t id) { return isObeyedBy(id); });
  if (another) command(handshake_.command());
  if (!handshake_.done()) return;
  for (const std::int32_t id : handshake_.unknown()) {
    fault("robot " + std::to_string(id) +
          " was ordered to turn, but the tracker saw no cap turn: check that the robot is switched "
          "on, drives and is under the camera");
  }
  dim();
}

/// Before the robots get their light table, the light of the handshake must be gone: they would
/// start programs by it.
void ExperimentController::dim() {
  phase_ = Phase::kDimming;
  command(standCommand(experiment_));
  light_.showEverywhere(experiment_.light.safe_intensity, "after the handshake");
  loop_.at(loop_.now() + kLightTimeout_us, [this] {
    if (phase_ == Phase::kDimming) askRobots();
  });
}

void ExperimentController::lightShown() {
  if (phase_ == Phase::kDimming) askRobots();
  if (phase_ == Phase::kLeaving) {
    safe_light_ = true;
    endIfStopped();
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
  const std::int64_t timeout = on_wire ? kSerialEchoTimeout_us : kLightEchoTimeout_us;
  loop_.at(loop_.now() + timeout, [this, timeout] {
    if (phase_ != Phase::kAskingRobots) return;
    fault("robots that did not confirm their light table within " +
          std::to_string(timeout / units::kSecond_us) + " s: " + silentRobots() +
          "; the script starts without them");
    startScript();
  });
}

void ExperimentController::sendRobots() {
  if (phase_ == Phase::kIdle) return;
  // A robot that has just booted must receive a stop in force before its first command.
  stops_.repeat();
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

void ExperimentController::endScript(const ScriptTransition& transition) {
  if (phase_ != Phase::kScript || stop_reached_) return;
  if (transition.kind == ScriptTransition::Kind::kOver && stop_rules_.given()) {
    // The script ended before the rules of stop_when were met.
    const std::string unmet = stop_rules_.unmet();
    fault(unmet);
    over_(Ending::kUnmet, unmet);
  } else if (transition.kind == ScriptTransition::Kind::kOver) {
    over_(Ending::kDone,
          "the script is over" + (transition.ended_by.empty() ? "" : ": " + transition.ended_by));
  } else if (transition.kind == ScriptTransition::Kind::kEnd) {
    over_(Ending::kUnmet, transition.fault);
  } else {
    phase_ = Phase::kLeaving;
    ended_ = light_.script().elapsed(loop_.now());
    leaving_because_ = transition.fault;
    command(standCommand(experiment_));
    light_.showEverywhere(experiment_.light.safe_intensity, "safe");
    sendStatus();
    loop_.at(loop_.now() + kLightTimeout_us, [this] {
      if (phase_ == Phase::kLeaving) over_(Ending::kUnmet, leaving_because_);
    });
  }
}

/// Ends the run once the safe light is shown and every robot has stopped. endScript() sets a
/// timeout for this.
void ExperimentController::endIfStopped() {
  if (phase_ == Phase::kLeaving && safe_light_ && allEchoed()) {
    over_(Ending::kUnmet, leaving_because_);
  }
}

void ExperimentController::take(const robot_status_t& status) {
  for (const std::string& dispute : owners_.take(status, loop_.now())) {
    fault(dispute);
    over_(Ending::kBroken, dispute);
  }
  for (const robot_state_t& robot : status.robots) states_[robot.robot_id] = robot;
  if (phase_ == Phase::kAskingRobots && allEchoed()) startScript();
  light_.take(status);
  endIfStopped();
}

bool ExperimentController::hasEchoed(const RobotSpec& robot) const {
  const bool takes_none = robot.body == Body::kReplay;  // a recorded robot takes no commands
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

void ExperimentController::take(const tracked_frame_t& frame) {
  if (phase_ == Phase::kHandshake) handshake_.see(frame);
  for (const tracked_pose_t& pose : frame.robots) {
    poses_[pose.robot_id] = pose;
    seen_utime_[pose.robot_id] = frame.utime;
  }
  light_.take(frame);
}

void ExperimentController::reportRefused() {
  if (!admission_.refused()) return;
  record_.limitReached(fmt::format(
      "more than {} robots on the bus are not of this run; further ones are ignored: is another "
      "program publishing here?",
      admission_.mostOthers()));
}

void ExperimentController::take(const robot_command_t& command) {
  if (command.sender == node_.identity().name) return;
  yielded_.take(admission_.admitted(command), loop_.now());
  reportRefused();
}

/// The message that ends the run does not advance the script.
void ExperimentController::endIfStopRulesHold() {
  const auto why = stop_rules_.met();
  if (!why || stop_reached_) return;
  stop_reached_ = true;
  over_(Ending::kDone, *why);
}

void ExperimentController::take(const analysis_t& analysis) {
  if (phase_ == Phase::kScript) {
    stop_rules_.take(analysis);
    endIfStopRulesHold();
  }
  if (!stop_reached_) light_.take(analysis);
}

void ExperimentController::take(const collective_t& message) {
  if (phase_ == Phase::kScript) {
    stop_rules_.take(message);
    endIfStopRulesHold();
  }
  if (!stop_reached_) light_.take(message);
}

void ExperimentController::take(const service_status_t& status) {
  const bool own = status.sender == node_.identity().name;
  if (own || phase_ == Phase::kIdle || status.last_error.empty()) return;
  const std::string what = status.sender + ": " + status.last_error;
  // The analyzer reports an overload. That costs results, but no data, unless the run waits for
  // them.
  const bool observes = status.sender == kObserverService ||
                        (status.sender == kAnalyzer && isDispensable(experiment_, kAnalyzer));
  record_.serviceError(what, !observes);
}

void ExperimentController::take(const experiment_command_t& request) {
  if (phase_ == Phase::kIdle) return;
  request_log_.take(request);
  // Above the limit the next periodic status has the answer.
  if (answers_.allows(loop_.now())) sendStatus();
}

std::string ExperimentController::execute(const experiment_command_t& request) {
  if (phase_ == Phase::kConcluded) return "the run is over";
  // Whatever else happens on the bus, the run can be ended.
  if (request.action != experiment_command_t::END && !requests_.allows(loop_.now())) {
    return fmt::format("too many requests: more than {} in {} s", kMostRequests,
                       kLimitPeriod_us / units::kSecond_us);
  }
  switch (request.action) {
    case experiment_command_t::PAUSE:
      return pauseScript(request.sender);
    case experiment_command_t::RESUME:
      return resumeScript(request.sender);
    case experiment_command_t::MARK:
      if (request.text.empty()) return "a mark needs a text";
      record_.markRequest(request.sender + ": " + request.text);
      return {};
    case experiment_command_t::END:
      end("ended by " + request.sender + (request.text.empty() ? "" : ": " + request.text));
      return {};
    case experiment_command_t::SEEK:
    case experiment_command_t::SPEED:
      return "a running lab cannot seek or change its speed; only the replay of a log can";
    default:
      return fmt::format("an unknown request ({})", request.action);
  }
}

/// A run that is ending because a condition was not met keeps that reason.
void ExperimentController::end(const std::string& why) {
  if (phase_ == Phase::kLeaving) {
    over_(Ending::kUnmet, leaving_because_ + "; " + why);
  } else {
    over_(Ending::kRequested, why);
  }
}

std::string ExperimentController::pauseScript(const std::string& who) {
  if (phase_ == Phase::kLeaving) return "the script is over";
  if (phase_ != Phase::kScript) return "the script has not begun";
  if (light_.script().paused()) return "the script is paused already";
  paused_utime_ = loop_.now();
  light_.pause();
  record_.markRequest("script paused by " + who, "lab resume, or resume on the page, continues it");
  return {};
}

std::string ExperimentController::resumeScript(const std::string& who) {
  if (phase_ != Phase::kScript || !light_.script().paused()) return "the script is not paused";
  record_.markRequest(fmt::format("script resumed by {} after {:.1f} s", who,
                                  units::seconds(loop_.now() - paused_utime_)));
  light_.resume();
  return {};
}

experiment_status_t ExperimentController::status() const {
  const Progress now = progress();
  experiment_status_t status{};
  // In virtual time the log must not depend on the name of the run's folder.
  if (!loop_.isVirtual()) status.run = run_;
  switch (phase_) {
    case Phase::kScript:
      status.phase = now.paused ? experiment_status_t::PAUSED : experiment_status_t::SCRIPT;
      break;
    case Phase::kLeaving:
      status.phase = experiment_status_t::LEAVING;
      break;
    case Phase::kConcluded:
      status.phase = experiment_status_t::ENDED;
      break;
    default:
      status.phase = experiment_status_t::PREPARING;
  }
  const bool in_script = phase_ == Phase::kScript;
  status.elapsed = now.elapsed;
  status.left = now.left;
  status.at_most = now.at_most ? 1 : 0;
  status.rate = 1;
  status.step = in_script ? light_.script().number() : -1;
  status.label = now.light;
  status.step_left =
      in_script ? light_.script().stepLeft(loop_.now()) : std::numeric_limits<double>::quiet_NaN();
  status.stop = now.stop;
  request_log_.write(status);
  return status;
}

void ExperimentController::sendStatus() {
  if (phase_ == Phase::kIdle) return;
  experiment_status_t message = status();
  node_.publish(channels::kExperimentStatus, message);
}

void ExperimentController::conclude(const std::string& why) {
  if (phase_ == Phase::kConcluded) return;
  light_.close();
  if (phase_ == Phase::kScript) ended_ = light_.script().elapsed(loop_.now());
  phase_ = Phase::kConcluded;
  command(standCommand(experiment_));
  record_.end(why);
  for (int copy = 0; copy < ExperimentRecord::kCopies; ++copy) sendStatus();
}

Progress ExperimentController::progress() const {
  Progress progress;
  const std::int64_t now = loop_.now();
  progress.begun =
      phase_ == Phase::kScript || phase_ == Phase::kLeaving || phase_ == Phase::kConcluded;
  if (phase_ == Phase::kScript) progress.elapsed = light_.script().elapsed(now);
  if (phase_ == Phase::kConcluded || phase_ == Phase::kLeaving) progress.elapsed = ended_;
  progress.left = std::max(0.0, experiment_.duration - progress.elapsed);
  progress.at_most = mayEndEarly(experiment_);
  progress.robots_stopped = phase_ == Phase::kConcluded ? 0 : stops_.robotsStopped();
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
