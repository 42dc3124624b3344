#include <fmt/format.h>

#include <limits>

#include "common/bus/channels.hpp"
#include "common/math/units.hpp"
#include "runner/live/experiment_controller.hpp"

/// The controller's part of EXPERIMENT_COMMAND and EXPERIMENT_STATUS.
namespace lab::runner {

void ExperimentController::take(const experiment_command_t& wish) {
  if (phase_ == Phase::kIdle) return;
  request_log_.take(wish);
  sendStatus();
}

std::string ExperimentController::obey(const experiment_command_t& wish) {
  if (phase_ == Phase::kConcluded) return "the run is over";
  switch (wish.action) {
    case experiment_command_t::PAUSE:
      return pauseScript(wish.sender);
    case experiment_command_t::RESUME:
      return resumeScript(wish.sender);
    case experiment_command_t::MARK:
      if (wish.text.empty()) return "a mark needs a text";
      mark(wish.sender + ": " + wish.text);
      return {};
    case experiment_command_t::END:
      end("ended by " + wish.sender + (wish.text.empty() ? "" : ": " + wish.text));
      return {};
    case experiment_command_t::SEEK:
    case experiment_command_t::SPEED:
      return "this is a running lab, whose time nobody sets: only a played log has that";
    default:
      return fmt::format("an unknown wish ({})", wish.action);
  }
}

/// A run that is ending because a condition was not met stays one, however soon it ends.
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
  mark("script paused by " + who);
  return {};
}

std::string ExperimentController::resumeScript(const std::string& who) {
  if (phase_ != Phase::kScript || !light_.script().paused()) return "the script is not paused";
  mark(fmt::format("script resumed by {} after {:.1f} s", who,
                   units::seconds(loop_.now() - paused_utime_)));
  light_.resume();
  return {};
}

experiment_status_t ExperimentController::status() const {
  const Progress now = progress();
  experiment_status_t status{};
  // Two virtual runs of one seed are equal to the bit; their folders are not.
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

}  // namespace lab::runner
