/// Commands the projector, plays the light script and confirms that its steps took effect.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <lab/light_command_t.hpp>
#include <lab/light_seen_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <optional>
#include <string>

#include "common/experiment/light_messages.hpp"
#include "common/service/node.hpp"
#include "runner/script/crowd_light.hpp"
#include "runner/script/delivery_times.hpp"
#include "runner/script/delivery_watch.hpp"
#include "runner/script/script_player.hpp"

namespace lab::runner {

class LightController {
 public:
  /// Callbacks to the rest of the run.
  struct Hooks {
    std::function<void(const experiment_event_t&)> record;
    std::function<void(const std::string&)> fault;
    std::function<void()> shown;            ///< the projector has shown the latest command
    std::function<void()> began;            ///< a step of the script was commanded
    std::function<bool()> chosen_by_light;  ///< whether robots choose their programs by the light
    std::function<void(const ScriptTransition&)> end;  ///< the script ended; never kStep
  };

  /// @param directory folder of the images that the experiment names
  LightController(Node& node, Loop& loop, const Experiment& experiment,
                  const std::filesystem::path& directory, Hooks hooks);

  /// Starts to repeat the latest command at 2 Hz.
  void begin();

  /// Shows uniform light that is not part of the script.
  void showEverywhere(double intensity, const std::string& label);

  /// Starts the script now.
  void startScript();

  /// Stop and restart the clock of the script (script_player.hpp).
  void pause();
  void resume();

  /// State of the script.
  [[nodiscard]] const ScriptPlayer& script() const { return player_; }

  /// Ends the script and records the times of its last step.
  void close();

  void take(const tracked_frame_t& frame);
  void take(const robot_status_t& status);
  void take(const analysis_t& analysis);
  /// Also applies the crowd rules of the step's layers: changed layers are a new command.
  void take(const collective_t& message);

  /// Label of the current light.
  [[nodiscard]] const std::string& label() const { return command_.label; }

 private:
  void take(const light_status_t& status);
  void update();
  void setStepTimer();
  void setTimers();
  void show(const ScriptTransition& transition);
  void send();
  void finishWatch();
  void closeWatch();
  [[nodiscard]] std::optional<program_id_t> expectedProgram() const;

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  Hooks hooks_;
  ExperimentImages images_;
  light_command_t command_{};
  ScriptPlayer player_;
  bool playing_ = false;
  std::optional<CrowdLight> crowd_;  ///< of the current step, if it has crowd rules
  bool needs_timer_ = false;         ///< steps were shown since the timer of the next one was set
  bool crowd_changed_ = false;       ///< its layers are not sent yet
  std::optional<DeliveryWatch> watch_;
  DeliveryTimes deliveries_;
  std::int64_t seen_light_utime_ =
      0;  ///< time of the last picture in which the sync patch was read
};

}  // namespace lab::runner
