/// The start-up handshake: all robots turn on the spot at once, each by a code word of its own, so
/// that the tracker finds which cap is which robot.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/robot_command_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <set>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "runner/live/turning_code.hpp"

namespace lab::runner {

/// Decides which robot turns in which direction and for how long; the controller sends its
/// command(). Robots that the tracker knows before a pass stand still. Robots that are not
/// recognised get a second pass with other code words.
class Handshake {
 public:
  explicit Handshake(const Experiment& experiment);

  /// Whether some robot must be recognised.
  [[nodiscard]] bool needed() const { return !waiting_.empty(); }

  /// Takes note of the robots that the tracker knows.
  void see(const tracked_frame_t& frame);

  /// Goes on to the next round or pass when it is time.
  /// @param obeyed whether a robot has echoed the last command
  /// @return whether command() has changed
  [[nodiscard]] bool advance(std::int64_t utime, const std::function<bool(std::int32_t)>& obeyed);

  [[nodiscard]] const robot_command_t& command() const { return command_; }
  [[nodiscard]] bool done() const { return waiting_.empty(); }

  /// Robots that were not recognised.
  [[nodiscard]] const std::vector<std::int32_t>& unknown() const { return unknown_; }

 private:
  void forgetKnown();
  [[nodiscard]] bool isKnown(std::int32_t robot_id) const;
  void beginPass(std::int64_t utime);
  [[nodiscard]] double speedOf(std::size_t robot) const;
  void beginRound(std::int64_t utime);
  [[nodiscard]] bool isRoundOver(std::int64_t utime,
                                 const std::function<bool(std::int32_t)>& obeyed);

  const Experiment& experiment_;
  double speed_;                       ///< [m/s] of the wheels, highest
  std::vector<std::int32_t> waiting_;  ///< robots of this pass
  std::set<std::int32_t> silent_;      ///< robots of this pass that did not obey in its first round
  std::vector<std::int32_t> unknown_;
  std::map<std::int32_t, std::int64_t> known_utime_;  ///< when the tracker last named the robot
  std::int64_t frame_utime_ = 0;                      ///< of the last frame
  TurningCode code_;
  int pass_ = -1;
  int round_ = 0;
  std::int64_t told_utime_ = 0;
  std::int64_t obeyed_utime_ = 0;  ///< when all robots turned; 0: not yet
  robot_command_t command_{};
};

}  // namespace lab::runner
