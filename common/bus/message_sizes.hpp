/// How large the encoding of a message may be that is received. A receiver refuses a larger one
/// before it decodes it: an empty curve of ANALYSIS has 14 bytes in the encoding and 240 in memory.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"

namespace lab {

class analysis_t;
class experiment_event_t;
class light_command_t;
class robot_calibration_t;
class robot_command_t;
class robot_senses_t;
class robot_status_t;
class robot_steps_t;
class robot_stop_t;
class service_status_t;
class sim_truth_t;
class tracked_details_t;
class tracked_frame_t;

/// [bytes] Four times the 60 KB that a message of a lab in real time has at most
/// (lcmtypes/README.md).
template <class Message>
inline constexpr std::size_t kLargestEncoding = 256'000;

/// Four times the 8 KB that the analyzer sends. Receivers keep one for each robot and program.
template <>
inline constexpr std::size_t kLargestEncoding<analysis_t> = 32'000;

/// [bytes] Of messages about each robot. In virtual time a lab has up to 10 000 robots, of about
/// 230 bytes in ROBOT_STATUS and 80 in TRACKED_FRAME, in which there may be 10 000 unidentified
/// ones. The heartbeat of robot_bridge has a row of 130 to 240 bytes for each.
inline constexpr std::size_t kLargestOfRobots = 4'000'000;

template <>
inline constexpr std::size_t kLargestEncoding<robot_calibration_t> = kLargestOfRobots;
template <>
inline constexpr std::size_t kLargestEncoding<robot_command_t> = kLargestOfRobots;
template <>
inline constexpr std::size_t kLargestEncoding<robot_senses_t> = kLargestOfRobots;
template <>
inline constexpr std::size_t kLargestEncoding<robot_status_t> = kLargestOfRobots;
template <>
inline constexpr std::size_t kLargestEncoding<robot_steps_t> = kLargestOfRobots;
template <>
inline constexpr std::size_t kLargestEncoding<service_status_t> = kLargestOfRobots;
template <>
inline constexpr std::size_t kLargestEncoding<sim_truth_t> = kLargestOfRobots;
template <>
inline constexpr std::size_t kLargestEncoding<tracked_details_t> = kLargestOfRobots;
template <>
inline constexpr std::size_t kLargestEncoding<tracked_frame_t> = kLargestOfRobots;

/// 160 layers, of which some are grids of 19 200 bytes or sequences of 1000 images of 69 bytes.
template <>
inline constexpr std::size_t kLargestEncoding<light_command_t> = 4'000'000;

/// START has the effective experiment file with the texts of its programs. Whatever the bus
/// carries, which takes no message above 16 MB.
template <>
inline constexpr std::size_t kLargestEncoding<experiment_event_t> = 16U << 20;

/// A stop is obeyed, whatever else it holds.
template <>
inline constexpr std::size_t kLargestEncoding<robot_stop_t> =
    std::numeric_limits<std::size_t>::max();

/// What was found and what was expected, if the encoding is too large for its type; else nothing.
template <class Message>
[[nodiscard]] std::optional<std::string> tooLarge(Bytes data) {
  if (data.size() <= kLargestEncoding<Message>) return std::nullopt;
  return "size: found " + std::to_string(data.size()) + " bytes, expected at most " +
         std::to_string(kLargestEncoding<Message>);
}

}  // namespace lab
