/// All message types that are sent on a channel.
#pragma once

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

namespace lab {

template <class... Messages>
struct MessageList {};

using AllMessages =
    MessageList<analysis_t, clock_t, collective_t, experiment_command_t, experiment_event_t,
                experiment_status_t, light_command_t, light_delivery_t, light_seen_t,
                light_status_t, link_status_t, robot_calibration_t, robot_command_t, robot_senses_t,
                robot_status_t, robot_steps_t, robot_stop_t, service_status_t, sim_truth_t,
                tracked_details_t, tracked_frame_t, tracker_status_t>;

}  // namespace lab
