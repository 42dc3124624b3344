/// Cuts the texts and lists of a message to what the page shows. The views keep messages, and the
/// page gets them again and again: whoever can send on the bus must not fill either.
#pragma once

#include <cstddef>

namespace lab {

class analysis_t;
class collective_t;
class experiment_event_t;
class experiment_status_t;
class light_delivery_t;
class light_status_t;
class link_status_t;
class robot_status_t;
class robot_stop_t;
class service_status_t;
class tracked_frame_t;
class tracker_status_t;

}  // namespace lab

namespace lab::dashboard {

/// [bytes] A remark of 500 characters has up to 2000, and a name before it.
inline constexpr std::size_t kLongestText = 2500;

// Of one message. The analyzer sends 2 curves and about 20 estimates in ANALYSIS, and about 10
// curves, 30 observables and at most 1000 members in COLLECTIVE.
inline constexpr std::size_t kMostCurves = 50;
inline constexpr std::size_t kMostEstimates = 100;
inline constexpr std::size_t kMostObservables = 100;
inline constexpr std::size_t kMostMembers = 1000;
inline constexpr std::size_t kMostDelays = 100;   ///< of LIGHT_DELIVERY, which has 4
inline constexpr std::size_t kMostPeers = 100;    ///< of LINK_STATUS; a gateway has at most 64
inline constexpr std::size_t kMostCounts = 1000;  ///< of SERVICE_STATUS; a node counts 256 streams
inline constexpr std::size_t kMostAddressed = 20'000;  ///< robots of ROBOT_STOP; more: every robot

void bound(analysis_t& message);
void bound(collective_t& message);
/// Leaves the experiment file of START as it is.
void bound(experiment_event_t& message);
void bound(experiment_status_t& message);
void bound(light_delivery_t& message);
void bound(light_status_t& message);
void bound(link_status_t& message);
void bound(robot_status_t& message);
void bound(robot_stop_t& message);
void bound(service_status_t& message);
void bound(tracker_status_t& message);
inline void bound(tracked_frame_t& /*message*/) {}  // it has no text; the views limit its robots

}  // namespace lab::dashboard
