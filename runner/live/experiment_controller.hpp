/// The runner's node on the bus: it commands the robots, plays the light script and writes the
/// record.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/collective_t.hpp>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/service/service_main.hpp"
#include "runner/live/experiment_record.hpp"
#include "runner/live/handshake.hpp"
#include "runner/live/progress.hpp"
#include "runner/live/rate_limit.hpp"
#include "runner/live/request_log.hpp"
#include "runner/live/robot_admission.hpp"
#include "runner/live/robot_owners.hpp"
#include "runner/live/stop_repeater.hpp"
#include "runner/script/light_controller.hpp"
#include "runner/script/stop_rules.hpp"
#include "runner/senses/sense_sender.hpp"
#include "runner/yielded_robots.hpp"

namespace lab::runner {

/// Conducts one experiment. begin() first lets the tracker learn which cap is which robot
/// (handshake.hpp), under full light. Then it sends the robots their light table, waits until each
/// has echoed it, and starts the clock of the script. Robots, light and record go on until the
/// script ends, conclude() is called, a request (EXPERIMENT_COMMAND) ends it, or a fault makes it
/// useless to go on. EXPERIMENT_STATUS reports the state at 2 Hz.
class ExperimentController final : public Service {
 public:
  /// @param effective the experiment file with every default filled in, for the record
  /// @param over called when the run should end, with the reason
  ExperimentController(const ServiceContext& context, std::string effective,
                       std::function<void(Ending, const std::string&)> over);

  void begin();

  /// Sets what is called, for the terminal, when somebody stops or releases robots, pauses or
  /// resumes the script, or writes a remark, from the page or from another terminal (request), and
  /// when a service that only observes reports an error (warning).
  void announceMarks(ExperimentRecord::Announce announce) {
    record_.announceMarks(std::move(announce));
  }

  /// Replaces the command to the robots. It is sent at once and repeated at 5 Hz. Its header is
  /// filled in.
  void command(robot_command_t command);

  /// Whether the robot has echoed the present command.
  [[nodiscard]] bool isObeyedBy(std::int32_t robot_id) const;

  /// Whether the script runs.
  [[nodiscard]] bool inScript() const { return phase_ == Phase::kScript; }

  /// Records a fault. The run continues.
  void fault(const std::string& what) { record_.fault(what); }

  /// Writes a remark into the record.
  void mark(const std::string& what) { record_.mark(what); }

  /// Ends the experiment: robots stop, and the reason is recorded.
  void conclude(const std::string& why);

  /// Stops every robot. The stop is repeated at 10 Hz until a sender releases it.
  void stopRobots(const std::string& why) { stops_.stopAll(why); }

  [[nodiscard]] Progress progress() const;
  [[nodiscard]] const std::vector<std::string>& faults() const { return record_.faults(); }

  /// The last pose of every robot that the tracker has seen.
  [[nodiscard]] const std::map<std::int32_t, tracked_pose_t>& lastPoses() const { return poses_; }

 private:
  void take(const robot_status_t& status);
  void take(const tracked_frame_t& frame);
  void take(const robot_command_t& command);
  void take(const analysis_t& analysis);
  void take(const collective_t& message);
  void endIfStopRulesHold();
  void take(const service_status_t& status);
  void take(const experiment_command_t& request);
  /// @return why the request is refused; empty: executed
  [[nodiscard]] std::string execute(const experiment_command_t& request);
  void end(const std::string& why);
  [[nodiscard]] std::string pauseScript(const std::string& who);
  [[nodiscard]] std::string resumeScript(const std::string& who);
  [[nodiscard]] experiment_status_t status() const;
  void sendStatus();
  void continueHandshake();
  void dim();
  void askRobots();
  void lightShown();
  void startScript();
  void endScript(const ScriptTransition& transition);
  void endIfStopped();
  void reportRefused();
  void sendRobots();
  [[nodiscard]] bool hasEchoed(const RobotSpec& robot) const;
  [[nodiscard]] bool allEchoed() const;
  [[nodiscard]] std::string silentRobots() const;

  enum class Phase { kIdle, kHandshake, kDimming, kAskingRobots, kScript, kLeaving, kConcluded };

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  std::string run_;  ///< its name
  std::function<void(Ending, const std::string&)> over_;

  Phase phase_ = Phase::kIdle;
  std::int64_t paused_utime_ = 0;  ///< begin of the last pause
  RequestLog request_log_;
  ExperimentRecord record_;
  double ended_ = 0;  ///< [s] of the script, once it has ended
  std::string leaving_because_;
  bool safe_light_ = false;  ///< in Phase::kLeaving: the safe light is shown
  robot_command_t robots_{};
  robot_command_t after_handshake_{};
  Handshake handshake_;
  LightController light_;
  StopRules stop_rules_;
  SenseSender senses_;
  bool stop_reached_ = false;
  YieldedRobots yielded_;
  StopRepeater stops_;
  // Whatever is published on the bus, the memory of this class and what it publishes stay bounded.
  RobotAdmission admission_;
  RateLimit requests_;  ///< of others that are executed
  RateLimit answers_;   ///< EXPERIMENT_STATUS sent at once
  RobotOwners owners_;
  std::map<std::int32_t, robot_state_t> states_;
  std::map<std::int32_t, tracked_pose_t> poses_;
  std::map<std::int32_t, std::int64_t> seen_utime_;
};

}  // namespace lab::runner
