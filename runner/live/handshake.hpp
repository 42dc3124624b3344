/// The start-up handshake: each robot in turn turns on the spot, so that the tracker sees which cap
/// it is.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/robot_command_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <set>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// Decides who turns, to and fro, and for how long; the controller does what it says. All others
/// stand meanwhile. A robot that the tracker already knows is left out. One that it does not
/// recognise has a second turn when all others are through.
class Handshake {
 public:
  explicit Handshake(const Experiment& experiment);

  /// Whether there is a robot to be recognised.
  [[nodiscard]] bool needed() const { return !waiting_.empty(); }

  /// Notes whom the tracker knows.
  void see(const tracked_frame_t& frame);

  /// Moves on where it is time.
  /// @param obeyed whether a robot does what it was told last
  /// @return whether somebody else has to turn now, or back: then command() has changed
  [[nodiscard]] bool advance(std::int64_t utime, const std::function<bool(std::int32_t)>& obeyed);

  [[nodiscard]] const robot_command_t& command() const { return command_; }
  [[nodiscard]] bool done() const { return waiting_.empty(); }

  /// Robots that were given up.
  [[nodiscard]] const std::vector<std::int32_t>& unknown() const { return unknown_; }

 private:
  struct Turn {
    std::int32_t robot_id = 0;
    int tries = 0;
  };

  void turn(std::int64_t utime);
  [[nodiscard]] bool swing(std::int64_t utime);
  void tell();
  [[nodiscard]] bool isOver(std::int64_t utime, const std::function<bool(std::int32_t)>& obeyed);

  const Experiment& experiment_;
  double speed_;  ///< [m/s] of the right wheel of who turns, minus that of the left one
  std::vector<Turn> waiting_;  ///< the first one turns
  std::set<std::int32_t> known_;
  std::vector<std::int32_t> unknown_;
  robot_command_t command_{};
  bool begun_ = false;
  std::int64_t told_utime_ = 0;
  std::int64_t obeyed_utime_ = 0;  ///< 0: not yet
  std::int64_t swung_utime_ = 0;   ///< when it turned back last
};

}  // namespace lab::runner
