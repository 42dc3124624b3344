/// The runner's part on the bus: it commands the robots, plays the light script and keeps the
/// record.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "common/service/service_main.hpp"
#include "runner/live/handshake.hpp"
#include "runner/live/request_log.hpp"
#include "runner/script/light_controller.hpp"
#include "runner/script/stop_rules.hpp"
#include "runner/yielded_robots.hpp"

namespace lab::runner {

/// How the run stands, for the progress line.
struct Progress {
  double elapsed = 0;                         ///< [s] of the script, without pauses
  double left = 0;                            ///< [s]
  bool at_most = false;                       ///< the run may end earlier
  bool paused = false;                        ///< the script's clock stands
  std::string stop;                           ///< how far the rules of stop_when are
  std::string light;                          ///< label of the step shown
  std::size_t robots_seen = 0;                ///< by the tracker, in the last second
  std::map<std::string, int> robots_running;  ///< robots by the name of their program
  std::int64_t lost = 0;                      ///< messages this process missed
};

/// How a run ends.
enum class Ending {
  kDone,       ///< as it should
  kRequested,  ///< somebody ended it by hand
  kUnmet,      ///< a condition of the script, or stop_when, was not met: marked
  kBroken,     ///< it makes no sense to go on
};

/// Conducts one experiment. begin() lets the tracker learn which cap is which robot
/// (handshake.hpp), under full light, then puts the robots under their light table and waits until
/// each has echoed it; then the script's clock starts. Robots, light and record go on until the
/// script's end, conclude(), a wish (EXPERIMENT_COMMAND), or a fault that ends the run. How it
/// stands is said in EXPERIMENT_STATUS.
class ExperimentController final : public Service {
 public:
  /// @param effective the experiment file with every default filled in, for the record.
  /// @param over called when the run is to end, with why.
  ExperimentController(const ServiceContext& context, std::string effective,
                       std::function<void(Ending, const std::string&)> over);

  void begin();

  /// Replaces what the robots are told: sent at once, repeated at 5 Hz. Its header is filled in.
  void command(robot_command_t command);

  /// Whether a robot has echoed what the robots are told now.
  [[nodiscard]] bool isObeyedBy(std::int32_t robot_id) const;

  /// Whether the robots were asked, and the script runs.
  [[nodiscard]] bool inScript() const { return phase_ == Phase::kScript; }

  /// Marks the run: what broke, while the rest goes on.
  void fault(const std::string& what);

  /// Writes something into the record that is no fault.
  void mark(const std::string& what);

  /// Ends the experiment: robots stand, the record says why.
  void conclude(const std::string& why);

  /// Stops every robot, for good: a stop is repeated at 10 Hz until somebody releases it.
  void stopRobots(const std::string& why);

  [[nodiscard]] Progress progress() const;
  [[nodiscard]] const std::vector<std::string>& faults() const { return faults_; }

  /// The last pose of every robot that the tracker has seen.
  [[nodiscard]] const std::map<std::int32_t, tracked_pose_t>& lastPoses() const { return poses_; }

 private:
  void take(const robot_status_t& status);
  void take(const tracked_frame_t& frame);
  void take(const robot_stop_t& stop);
  void take(const robot_command_t& command);
  void take(const analysis_t& analysis);
  void take(const service_status_t& status);
  void take(const experiment_command_t& wish);
  [[nodiscard]] std::string obey(const experiment_command_t& wish);
  void end(const std::string& why);
  [[nodiscard]] std::string pauseScript(const std::string& who);
  [[nodiscard]] std::string resumeScript(const std::string& who);
  [[nodiscard]] experiment_status_t status() const;
  void sendStatus();
  void latch(const robot_stop_t& stop);
  void repeatStops();
  void shakeHands();
  void dim();
  void askRobots();
  void lightShown();
  void startScript();
  void endScript(const ScriptTransition& turn);
  void leave();
  void announceStart();
  void record(experiment_event_t event);
  void sendRobots();
  void checkOwner(const robot_status_t& status);
  [[nodiscard]] bool hasEchoed(const RobotSpec& robot) const;
  [[nodiscard]] bool allEchoed() const;
  [[nodiscard]] std::string silentRobots() const;

  enum class Phase { kIdle, kHandshake, kDimming, kAskingRobots, kScript, kLeaving, kConcluded };

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  std::string run_;  ///< its name
  std::string effective_;
  std::string light_calibration_;  ///< its file's text, for the record; empty: none
  std::function<void(Ending, const std::string&)> over_;

  Phase phase_ = Phase::kIdle;
  std::int64_t paused_utime_ = 0;  ///< of the last pause
  RequestLog request_log_;
  double ended_ = 0;  ///< [s] of the script, once it has ended
  std::string leaving_because_;
  bool safe_light_ = false;  ///< while leaving: the safe light is shown
  robot_command_t robots_{};
  robot_command_t after_handshake_{};
  Handshake handshake_;
  LightController light_;
  StopRules stop_rules_;
  bool stop_reached_ = false;
  YieldedRobots yielded_;
  std::map<std::int32_t, std::int64_t> latched_;  ///< seq of the stop in force, by robot
  std::set<std::int64_t> stops_heard_;
  std::set<std::string> complaints_;  ///< of services, already recorded

  struct Owner {
    std::string sender;
    std::int64_t instance = 0;
    std::int64_t utime = 0;
  };
  std::map<std::int32_t, Owner> owners_;
  std::set<std::int32_t> disputed_;
  std::map<std::int32_t, robot_state_t> states_;
  std::map<std::int32_t, tracked_pose_t> poses_;
  std::map<std::int32_t, std::int64_t> seen_utime_;
  std::vector<std::string> faults_;
};

}  // namespace lab::runner
