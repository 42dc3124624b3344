#include "dashboard/views/bounded_messages.hpp"

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/collective_t.hpp>
#include <lab/experiment_event_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <lab/light_delivery_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/link_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/tracker_status_t.hpp>
#include <string>
#include <vector>

#include "common/bus/message_header.hpp"
#include "common/text/utf8.hpp"

namespace lab::dashboard {
namespace {

template <class... Texts>
void cutTexts(Texts&... texts) {
  (texts.resize(utf8Prefix(texts, kLongestText).size()), ...);
}

/// @param size the field with the length of the list
template <class Part>
void cutList(std::vector<Part>& list, std::int32_t& size, std::size_t most) {
  if (list.size() > most) list.resize(most);
  size = static_cast<std::int32_t>(list.size());
}

void cutName(std::string& name) { name.resize(utf8Prefix(name, kLongestSender).size()); }

}  // namespace

void bound(analysis_t& message) {
  cutTexts(message.program.name);
  cutList(message.curves, message.num_curves, kMostCurves);
  cutList(message.estimates, message.num_estimates, kMostEstimates);
  for (curve_t& curve : message.curves) cutTexts(curve.name, curve.unit);
  for (estimate_t& estimate : message.estimates) {
    cutTexts(estimate.name, estimate.unit, estimate.note);
  }
}

void bound(collective_t& message) {
  cutTexts(message.program.name);
  cutList(message.observables, message.num_observables, kMostObservables);
  cutList(message.curves, message.num_curves, kMostCurves);
  cutList(message.members, message.num_members, kMostMembers);
  for (observable_t& one : message.observables) cutTexts(one.name, one.unit);
  for (observable_curve_t& curve : message.curves) cutTexts(curve.name, curve.x_unit, curve.unit);
}

void bound(experiment_event_t& message) {
  if (message.kind != experiment_event_t::START) cutTexts(message.text);
  cutTexts(message.fingerprints, message.version, message.label, message.ended_by);
}

void bound(experiment_status_t& message) {
  cutTexts(message.run, message.label, message.stop, message.commander, message.refusal);
}

void bound(light_delivery_t& message) {
  cutList(message.delays, message.num_delays, kMostDelays);
  for (light_delay_t& delay : message.delays) cutTexts(delay.until);
}

void bound(light_status_t& message) {
  cutTexts(message.commander, message.label, message.calibration_id, message.last_refusal,
           message.display, message.vsync, message.trouble);
}

void bound(link_status_t& message) {
  cutTexts(message.host);
  cutList(message.peers, message.num_peers, kMostPeers);
  for (link_peer_t& peer : message.peers) cutTexts(peer.host, peer.trouble);
}

void bound(robot_status_t& message) {
  for (robot_state_t& robot : message.robots) cutTexts(robot.program.name);
}

void bound(robot_stop_t& message) {
  cutName(message.sender);
  cutTexts(message.reason);
  if (message.robot_ids.size() <= kMostAddressed) return;
  message.robot_ids.clear();
  message.num_robots = 0;
}

void bound(service_status_t& message) {
  cutTexts(message.host, message.version, message.last_error);
  cutList(message.sent, message.num_sent, kMostCounts);
  cutList(message.received, message.num_received, kMostCounts);
  for (channel_count_t& count : message.sent) cutName(count.channel);
  for (stream_count_t& count : message.received) {
    cutName(count.channel);
    cutName(count.sender);
  }
}

void bound(tracker_status_t& message) {
  cutTexts(message.camera, message.trouble, message.pixels, message.calibration_id,
           message.warning);
}

}  // namespace lab::dashboard
