/// The runner's part of the light: it commands the projector, plays the script and proves that the
/// steps arrived.
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
#include "runner/script/delivery_times.hpp"
#include "runner/script/delivery_watch.hpp"
#include "runner/script/script_player.hpp"

namespace lab::runner {

class LightController {
 public:
  /// What the light has to do with the rest of the run.
  struct Hooks {
    std::function<void(const experiment_event_t&)> record;
    std::function<void(const std::string&)> fault;
    std::function<void()> shown;            ///< a frame of the light commanded last has been shown
    std::function<void()> began;            ///< a step of the script was commanded
    std::function<bool()> chosen_by_light;  ///< whether robots take their programs from the light
    std::function<void(const ScriptTransition&)> end;  ///< of the script: no kStep
  };

  /// @param directory of the images that the experiment names
  LightController(Node& node, Loop& loop, const Experiment& experiment,
                  const std::filesystem::path& directory, Hooks hooks);

  /// From now on the light commanded last is repeated.
  void begin();

  /// Shows the same everywhere, outside the script.
  void showEverywhere(double intensity, const std::string& label);

  /// The script's clock starts now.
  void startScript();

  /// The script's clock stands and goes on: script_player.hpp.
  void pause();
  void resume();

  /// Where the script is.
  [[nodiscard]] const ScriptPlayer& script() const { return player_; }

  /// The script goes no further; what is known of its last step is recorded.
  void close();

  void take(const tracked_frame_t& frame);
  void take(const robot_status_t& status);
  void take(const analysis_t& analysis);

  /// Of the step shown.
  [[nodiscard]] const std::string& label() const { return command_.label; }

 private:
  void take(const light_status_t& status);
  void look();
  void lookWhenDue();
  void setTimers();
  void show(const ScriptTransition& turn);
  void send();
  void finishWatch();
  void closeWatch();
  [[nodiscard]] std::optional<program_t> expectedProgram() const;

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  Hooks hooks_;
  ExperimentImages images_;
  light_command_t command_{};
  ScriptPlayer player_;
  bool playing_ = false;
  std::optional<DeliveryWatch> watch_;
  DeliveryTimes deliveries_;
  std::int64_t seen_light_utime_ = 0;  ///< of the last picture that showed the sync patch
};

}  // namespace lab::runner
