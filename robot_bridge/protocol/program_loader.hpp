/// Loads programs of motion into a robot.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "robot/wire/messages.hpp"

namespace lab::bridge {

/// The programs that a robot has, and the sequence of commands that loads another one: LOAD_BEGIN,
/// LOAD_DATA for each 32 bytes, LOAD_END. The caller sends the commands and reports their results.
class ProgramLoader {
 public:
  /// Nothing is known of the robot's programs.
  void forget();

  /// Whether the robot has said what it has.
  [[nodiscard]] bool isKnown() const { return known_; }
  void learn(const wire::Programs& programs);

  [[nodiscard]] bool has(std::uint32_t hash) const;

  /// The next command for loading this program, without its seq. Another program begins anew.
  [[nodiscard]] wire::Frame next(std::uint32_t hash, const std::vector<std::uint8_t>& code,
                                 std::int64_t now);

  /// What the answer to a command means.
  enum class Result {
    kGoesOn,   ///< the next command is due
    kLoaded,   ///< the robot has the program
    kBusy,     ///< the same command again, a little later
    kNoPlace,  ///< the programs in force must be given up first
    kFailed    ///< the robot does not take the program
  };
  Result finish(const wire::Frame& command, const wire::Ack& ack);

  /// When the program that was loaded last was begun [us].
  [[nodiscard]] std::int64_t begunUtime() const { return begun_utime_; }

 private:
  bool known_ = false;
  std::vector<std::uint32_t> hashes_;
  std::uint32_t hash_ = 0;  ///< being loaded; 0: none
  std::size_t step_ = 0;    ///< 0: LOAD_BEGIN
  int attempts_ = 0;
  std::int64_t begun_utime_ = 0;
};

}  // namespace lab::bridge
