/// Which numbers a message can hold at all. Whatever receives a message, live or from a log, checks
/// them once, before anything computes with them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "common/bus/value_checker.hpp"

namespace lab {

class analysis_t;
class collective_t;
class experiment_event_t;
class experiment_status_t;
class light_delivery_t;
class light_seen_t;
class light_status_t;
class link_status_t;
class robot_calibration_t;
class robot_senses_t;
class robot_status_t;
class robot_steps_t;
class robot_stop_t;
class service_status_t;
class sim_truth_t;
class tracked_details_t;
class tracked_frame_t;
class tracker_status_t;

// The ranges are far beyond what any lab measures: they exclude what is damaged or forged, and what
// the code behind them cannot compute with. What a receiver allows of these is its own affair. So a
// program that no robot can run passes here, for the robot may still report that it has stopped:
// the analysis refuses it.
void checkValues(ValueChecker& check, const analysis_t& analysis);
void checkValues(ValueChecker& check, const collective_t& crowd);
void checkValues(ValueChecker& check, const experiment_event_t& event);
void checkValues(ValueChecker& check, const experiment_status_t& status);
void checkValues(ValueChecker& check, const light_delivery_t& delivery);
void checkValues(ValueChecker& check, const light_seen_t& seen);
void checkValues(ValueChecker& check, const light_status_t& status);
void checkValues(ValueChecker& check, const link_status_t& status);
void checkValues(ValueChecker& check, const robot_calibration_t& calibration);
void checkValues(ValueChecker& check, const robot_senses_t& senses);
void checkValues(ValueChecker& check, const robot_status_t& status);
void checkValues(ValueChecker& check, const robot_steps_t& steps);
void checkValues(ValueChecker& check, const service_status_t& status);
void checkValues(ValueChecker& check, const sim_truth_t& truth);
void checkValues(ValueChecker& check, const tracked_details_t& details);
void checkValues(ValueChecker& check, const tracked_frame_t& frame);
void checkValues(ValueChecker& check, const tracker_status_t& status);

/// The other types have only their header: their receivers answer an order with the reason of its
/// refusal (ROBOT_COMMAND, LIGHT_COMMAND, EXPERIMENT_COMMAND), or use the header alone (CLOCK).
template <class Message>
void checkValues(ValueChecker& /*check*/, const Message& /*message*/) {}

void checkHeader(ValueChecker& check, std::int64_t utime, std::int64_t seq);

/// The first number of a message that no part of the lab can have sent, with what was found and
/// what was expected; nothing if there is none.
template <class Message>
[[nodiscard]] std::optional<std::string> impossibleValue(const Message& message) {
  // A stop is obeyed, whatever its time is.
  if constexpr (std::is_same_v<Message, robot_stop_t>) return std::nullopt;
  ValueChecker check;
  checkHeader(check, message.utime, message.seq);
  checkValues(check, message);
  return check.problem();
}

/// The same for the header of a message that is not decoded.
[[nodiscard]] std::optional<std::string> impossibleHeader(std::string_view channel,
                                                          std::int64_t utime, std::int64_t seq);

/// Impossible numbers that were found in a message.
struct ImpossibleNumbers {
  std::string first;       ///< the first one, as of impossibleValue()
  std::int64_t count = 1;  ///< of robots and detections that were removed; 1: the whole message
  bool usable = false;     ///< the rest of the message may be used
};

/// Removes the robots and detections that have an impossible number.
/// @return how many; 0 if none remains: the message is of no use
std::int64_t removeImpossibleParts(robot_status_t& status);
std::int64_t removeImpossibleParts(tracked_frame_t& frame);
template <class Message>
std::int64_t removeImpossibleParts(Message& /*message*/) {
  return 0;
}

/// Checks a message as impossibleValue() does. In a message about many robots, one of them with an
/// impossible number is removed, and the others are used.
/// @return nothing: all numbers are possible
template <class Message>
[[nodiscard]] std::optional<ImpossibleNumbers> removeImpossible(Message& message) {
  const std::optional<std::string> problem = impossibleValue(message);
  if (!problem) return std::nullopt;
  const std::int64_t removed = removeImpossibleParts(message);
  if (removed == 0 || impossibleValue(message)) return ImpossibleNumbers{*problem};
  return ImpossibleNumbers{*problem, removed, true};
}

}  // namespace lab
