#include "tests/fuzz/messages.hpp"

#include <array>
#include <lab/analysis_t.hpp>
#include <lab/clock_t.hpp>
#include <lab/collective_t.hpp>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_event_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <lab/light_command_t.hpp>
#include <lab/light_delivery_t.hpp>
#include <lab/light_seen_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/link_status_t.hpp>
#include <lab/robot_calibration_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_senses_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <lab/tracker_status_t.hpp>

#include "common/bus/channels.hpp"

namespace lab::fuzz {
namespace {

/// In the order of channels::kAll.
template <class... Messages>
std::array<std::int64_t, sizeof...(Messages)> fingerprints() {
  return {Messages::getHash()...};
}

}  // namespace

TimedMessage nextMessage(Input& input) {
  static const auto kFingerprints =
      fingerprints<robot_command_t, robot_stop_t, robot_status_t, robot_steps_t,
                   robot_calibration_t, robot_calibration_t, tracked_frame_t, tracked_details_t,
                   tracker_status_t, light_command_t, light_status_t, light_seen_t,
                   light_delivery_t, link_status_t, analysis_t, service_status_t,
                   experiment_event_t, experiment_command_t, experiment_status_t, clock_t,
                   sim_truth_t, robot_senses_t, collective_t>();
  static_assert(std::tuple_size_v<std::decay_t<decltype(kFingerprints)>> == channels::kAll.size());
  const auto first = input.number<std::uint8_t>();
  const std::size_t channel = (first & 0x7FU) % channels::kAll.size();
  TimedMessage message;
  message.channel = channels::kAll.at(channel);
  message.wait_us = input.number<std::uint8_t>() * std::int64_t{4000};
  const auto fields = input.take(input.number<std::uint16_t>());
  if (first >= 0x80) {
    message.data.assign(fields.begin(), fields.end());
  } else {
    message.data = encoding(kFingerprints.at(channel), fields);
  }
  return message;
}

}  // namespace lab::fuzz
