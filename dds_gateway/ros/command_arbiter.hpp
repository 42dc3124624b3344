/// Decides which ROS 2 publisher may drive which robot, and makes the commands for the robots.
/// Without bus and clock.
#pragma once

#include <cstdint>
#include <lab/program_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "dds_gateway/dds/endpoint.hpp"
#include "dds_gateway/ros/from_ros.hpp"

namespace lab::gateway {

/// The result of a request.
enum class Answer {
  kTaken,
  kClamped,     ///< taken, slowed down to the limit of the wheels
  kNotFinite,   ///< a number is nan or infinite
  kOutOfRange,  ///< a number is outside its range
  kNoRobot,     ///< the experiment has no such robot, or does not allow driving it
  kNoProgram,   ///< the experiment has no such program
  kNoLoading,   ///< the experiment does not allow texts of programs
  kBadProgram,  ///< a text that is no program
  kOwned,       ///< another publisher owns it
  kStopped,     ///< ROBOT_STOP is in force
  kLabHolds,    ///< the lab itself stops or drives the robot
  kFlood,       ///< more messages per second than are processed
};
inline constexpr int kAnswers = 12;

/// "owned by another publisher"
[[nodiscard]] std::string textOf(Answer answer);

/// Priorities, the highest first:
///
/// 1. ROBOT_STOP: no publisher owns the robot any more, and requests for it are refused until the
///    stop is released.
/// 2. ROBOT_COMMAND of another sender that stops or drives the robot (the lab's handshake, the end
///    of the run): the same.
/// 3. One publisher. The first publisher that commands a robot owns it until it has been silent for
///    `timeout`. Meanwhile other publishers are refused for that robot.
/// 4. The lab's light table.
///
/// A driven robot is stopped when its publisher has been silent for `timeout`, and released to the
/// lab when the silence has lasted for kGiveBack_us. A robot with a commanded program, or with the
/// command to stand, keeps it until it is released or driven.
class CommandArbiter {
 public:
  static constexpr std::int64_t kGiveBack_us = 5'000'000;

  /// @param robots that may be driven
  CommandArbiter(std::set<std::int32_t> robots, const WheelLimits& wheels, std::int64_t timeout_us)
      : robots_(std::move(robots)), wheels_(wheels), timeout_us_(timeout_us) {}

  Answer drive(std::int32_t robot, dds::WriterId writer, const ros::Twist& twist, std::int64_t now);
  /// @param order of mode STAND or TABLE
  /// @param robots their orders have one seq; each must be one that may be driven
  /// @return the answer for the first refused robot; the others obey
  Answer command(const std::vector<std::int32_t>& robots, dds::WriterId writer,
                 const robot_order_t& order, std::int64_t now);
  /// Returns the robots to the lab.
  Answer release(const std::vector<std::int32_t>& robots, dds::WriterId writer, std::int64_t now);

  /// ROBOT_COMMAND of another sender.
  void take(const robot_command_t& command, std::int64_t now);
  void take(const robot_status_t& status);
  void take(const robot_stop_t& stop, std::int64_t now);

  /// The watchdog. Call it at least every 20 ms.
  void tick(std::int64_t now);

  /// The commands to send now: new orders at once, at most 50 times a second, and repeats. Of the
  /// headers only seq is set.
  [[nodiscard]] std::vector<robot_command_t> due(std::int64_t now);

  [[nodiscard]] const std::set<std::int32_t>& robots() const { return robots_; }
  [[nodiscard]] std::size_t held() const { return holds_.size(); }
  /// How often a driven robot was stopped because its publisher was silent.
  [[nodiscard]] std::int64_t silences() const { return silences_; }

 private:
  struct Hold {
    dds::WriterId writer = 0;
    std::int64_t heard_utime = 0;
    bool driven = false;
    bool silent = false;   ///< driven, and stopped by silence
    robot_order_t order;   ///< without its robots
    std::int64_t seq = 0;  ///< of an order other than driving
    std::int64_t sent_utime = 0;
  };
  struct LabOrder {
    std::int8_t mode = robot_order_t::TABLE;
    std::int64_t utime = 0;
  };

  [[nodiscard]] Answer refusal(std::int32_t robot, dds::WriterId writer, std::int64_t now) const;
  void giveBack(std::int32_t robot);
  void driveMessage(std::int64_t now, std::vector<robot_command_t>& out);
  void orderMessages(std::int64_t now, std::vector<robot_command_t>& out);

  std::set<std::int32_t> robots_;
  WheelLimits wheels_;
  std::int64_t timeout_us_;
  std::map<std::int32_t, Hold> holds_;
  std::map<std::int32_t, LabOrder> lab_;
  std::set<std::int32_t> latched_;
  std::map<std::int32_t, std::int64_t> stop_utime_;
  std::set<std::int32_t> given_back_;
  std::int64_t seq_ = 0;
  std::int64_t drive_seq_ = 0;
  std::int64_t drive_sent_utime_ = 0;
  bool drive_changed_ = false;
  std::int64_t silences_ = 0;
};

}  // namespace lab::gateway
