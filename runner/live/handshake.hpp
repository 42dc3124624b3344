/// The start-up handshake: one robot after the other turns on the spot, so that the tracker finds
/// which cap is which robot.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/robot_command_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <set>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// Decides which robot turns, in which direction and for how long; the controller sends its
/// command(). All other robots stand still. A robot that the tracker knows already is skipped. A
/// robot that is not recognised gets a second try after all others.
class Handshake {
 public:
  explicit Handshake(const Experiment& experiment);

  /// Whether some robot must be recognised.
  [[nodiscard]] bool needed() const { return !waiting_.empty(); }

  /// Takes note of the robots that the tracker knows.
  void see(const tracked_frame_t& frame);

  /// Goes on to the next direction or robot when it is time.
  /// @param obeyed whether a robot has echoed the last command
  /// @return whether command() has changed
  [[nodiscard]] bool advance(std::int64_t utime, const std::function<bool(std::int32_t)>& obeyed);

  [[nodiscard]] const robot_command_t& command() const { return command_; }
  [[nodiscard]] bool done() const { return waiting_.empty(); }

  /// Robots that were not recognised.
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
  double speed_;               ///< [m/s] speed of the right wheel; the left wheel has its negative
  std::vector<Turn> waiting_;  ///< the first one turns now
  std::set<std::int32_t> known_;
  std::vector<std::int32_t> unknown_;
  robot_command_t command_{};
  bool begun_ = false;
  std::int64_t told_utime_ = 0;
  std::int64_t obeyed_utime_ = 0;  ///< 0: no echo yet
  std::int64_t swung_utime_ = 0;   ///< last change of direction
};

}  // namespace lab::runner
