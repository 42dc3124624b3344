/// Compares the poses of the tracker in a log with the true poses of the simulator.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <lab/sim_truth_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <lab/tracker_status_t.hpp>
#include <map>
#include <numbers>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"

namespace lab::system_test {

struct TruthComparison {
  double worst = 0;       ///< [m] largest distance of a pose from its robot, without swaps
  double worst_turn = 0;  ///< [rad] largest heading error, without flips
  double settled = 0;     ///< [m] worst of those that are late enough
  std::int64_t compared = 0;
  std::int64_t swapped = 0;       ///< poses at the place of another robot
  std::int64_t flipped = 0;       ///< poses with a heading error above 90 degrees
  std::int64_t unidentified = 0;  ///< caps without identity
  std::int64_t collisions = 0;
  tracker_status_t tracker{};
};

/// Compares TRACKED_FRAME with SIM_TRUTH (10 Hz) where both have the same time.
/// @param settled_us `settled` counts poses later than this after the first frame
inline TruthComparison compareWithTruth(const std::filesystem::path& run_folder,
                                        std::int64_t settled_us = 0) {
  constexpr double kOtherRobot = 0.03;  // [m] two robots cannot be nearer than 7.5 cm
  TruthComparison result;
  std::map<std::int64_t, std::map<std::int32_t, true_pose_t>> truth;
  std::map<std::int64_t, std::vector<tracked_pose_t>> seen;
  readLog({run_folder / "log.lcmlog"}, [&](const Packet& packet) {
    sim_truth_t message{};
    tracked_frame_t frame{};
    if (packet.channel == channels::kSimTruth && decode(packet.data, message)) {
      for (const true_pose_t& pose : message.robots) truth[message.utime][pose.robot_id] = pose;
      result.collisions = message.collisions;
    }
    if (packet.channel == channels::kTrackedFrame && decode(packet.data, frame)) {
      seen[frame.utime] = frame.robots;
      result.unidentified += frame.num_unidentified;
    }
    if (packet.channel == channels::kTrackerStatus) {
      static_cast<void>(decode(packet.data, result.tracker));
    }
  });
  for (const auto& [utime, poses] : seen) {
    const auto at = truth.find(utime);
    if (at == truth.end()) continue;
    for (const tracked_pose_t& pose : poses) {
      ++result.compared;
      const true_pose_t& expected = at->second.at(pose.robot_id);
      const double off = std::hypot(pose.x - expected.x, pose.y - expected.y);
      const double turn =
          std::abs(std::remainder(pose.theta - expected.theta, 2 * std::numbers::pi));
      if (off > kOtherRobot) {
        ++result.swapped;
      } else if (turn > std::numbers::pi / 2) {
        ++result.flipped;
      } else {
        result.worst = std::max(result.worst, off);
        if (utime - seen.begin()->first > settled_us)
          result.settled = std::max(result.settled, off);
        result.worst_turn = std::max(result.worst_turn, turn);
      }
    }
  }
  return result;
}

}  // namespace lab::system_test
