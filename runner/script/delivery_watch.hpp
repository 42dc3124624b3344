/// Confirms that a step of the light script took effect: shown by the projector, seen by the
/// camera, executed by the robots.
#pragma once

#include <cstdint>
#include <lab/experiment_event_t.hpp>
#include <lab/light_seen_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <map>
#include <optional>

namespace lab::runner {

/// Collects the times of one step from the status messages of projector, tracker and robots.
class DeliveryWatch {
 public:
  /// @param step with number, label and commanded_utime
  /// @param command_instance, command_seq identify the LIGHT_COMMAND of the step
  /// @param expected program of every robot under the new light, if the light changes at once and
  ///   is uniform; otherwise nothing, and no robot is expected to act
  /// @param robots number of robots; each must report after the presentation
  DeliveryWatch(const experiment_event_t& step, std::int64_t command_instance,
                std::int64_t command_seq, const std::optional<program_id_t>& expected,
                std::size_t robots)
      : step_(step),
        instance_(command_instance),
        seq_(command_seq),
        expected_(expected),
        robots_expected_(robots) {}

  void take(const light_status_t& status);
  void take(const light_seen_t& seen);
  void take(const robot_status_t& status);

  /// Called if a camera reads the sync patch: the step is then complete only after the camera saw
  /// the light.
  void expectSeen() { must_be_seen_ = true; }

  /// Whether the light was shown, seen (if expected), and executed by every robot that had to
  /// change.
  [[nodiscard]] bool complete() const;

  /// The step with the times known so far.
  [[nodiscard]] experiment_event_t event() const;

 private:
  struct RobotWatch {
    bool must_change = false;
    bool reported_since = false;  ///< a status was sampled after the presentation
    std::int64_t acted_utime = 0;
  };

  experiment_event_t step_;
  std::int64_t instance_;
  std::int64_t seq_;
  std::optional<program_id_t> expected_;
  std::size_t robots_expected_;
  std::int64_t presented_utime_ = 0;
  bool must_be_seen_ = false;
  std::int8_t sync_ = -1;  ///< value of the sync patch in the first frame of the step
  std::int64_t seen_utime_ = 0;
  std::map<std::int32_t, RobotWatch> robots_;
};

}  // namespace lab::runner
