/// The message types as data: every type, its fields in order, and two visitors of them that do not
/// use LCM's generated code.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <functional>
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
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace lab {

template <class... Types>
struct TypeList {};

/// Types that are sent on a channel.
using ChannelTypes =
    TypeList<analysis_t, clock_t, collective_t, experiment_command_t, experiment_event_t,
             experiment_status_t, light_command_t, light_delivery_t, light_seen_t, light_status_t,
             link_status_t, robot_calibration_t, robot_command_t, robot_senses_t, robot_status_t,
             robot_steps_t, robot_stop_t, service_status_t, sim_truth_t, tracked_details_t,
             tracked_frame_t, tracker_status_t>;

/// Types that are parts of those.
using PartTypes = TypeList<cap_detail_t, channel_count_t, crowd_member_t, curve_t, estimate_t,
                           light_band_t, light_delay_t, light_drive_t, light_layer_t, link_peer_t,
                           motor_calibration_t, observable_curve_t, observable_t, parameter_t,
                           program_id_t, program_t, robot_order_t, robot_state_t, robot_step_t,
                           sense_values_t, stream_count_t, tracked_pose_t, true_pose_t>;

/// Calls `visit.operator()<Type>()` for every type of both lists.
template <class Visit, class... Types>
void forEachType(TypeList<Types...> /*list*/, Visit visit) {
  (visit.template operator()<Types>(), ...);
}

inline auto fields(cap_detail_t& m) {
  return std::tie(m.robot_id, m.track, m.used, m.spacing, m.white, m.u, m.v);
}
inline auto fields(channel_count_t& m) { return std::tie(m.channel, m.messages); }
inline auto fields(crowd_member_t& m) {
  return std::tie(m.robot_id, m.cluster, m.density, m.hexatic);
}
inline auto fields(curve_t& m) {
  return std::tie(m.name, m.unit, m.num_lags, m.lag, m.value, m.sigma, m.exact, m.paper, m.windows,
                  m.biased);
}
inline auto fields(estimate_t& m) {
  return std::tie(m.name, m.unit, m.value, m.sigma, m.low, m.high, m.theory, m.note);
}
inline auto fields(observable_curve_t& m) {
  return std::tie(m.name, m.x_unit, m.unit, m.num_points, m.x, m.value, m.low, m.high);
}
inline auto fields(observable_t& m) {
  return std::tie(m.name, m.unit, m.now, m.mean, m.sigma, m.low, m.high);
}
inline auto fields(parameter_t& m) { return std::tie(m.name, m.value, m.unit); }
inline auto fields(program_id_t& m) { return std::tie(m.hash, m.name); }
inline auto fields(program_t& m) {
  return std::tie(m.id, m.text, m.size, m.code, m.num_parameters, m.parameters);
}
inline auto fields(light_band_t& m) { return std::tie(m.low, m.high, m.program); }
inline auto fields(light_layer_t& m) {
  return std::tie(m.kind, m.blend, m.x, m.y, m.angle, m.size, m.inner, m.softness, m.intensity,
                  m.intensity2, m.image, m.seed, m.phase, m.columns, m.rows, m.num_grid, m.grid);
}
inline auto fields(light_drive_t& m) {
  return std::tie(m.layer, m.vx, m.vy, m.spin, m.phase_rate, m.waveform, m.period, m.low, m.start,
                  m.seed, m.image_rate, m.image_loop, m.num_images, m.images, m.follow,
                  m.num_robots, m.robots, m.predict, m.stale, m.when_lost, m.rate, m.decay,
                  m.diffusion, m.gate, m.gate_robot, m.gate_program, m.gate_x, m.gate_y,
                  m.gate_radius);
}
inline auto fields(light_delay_t& m) {
  return std::tie(m.until, m.count, m.p50, m.p95, m.p99, m.max);
}
inline auto fields(robot_order_t& m) {
  return std::tie(m.num_robots, m.robot_ids, m.mode, m.wheel_left, m.wheel_right, m.light_sensor,
                  m.hysteresis, m.num_bands, m.bands, m.reverse_on, m.reverse_distance,
                  m.reverse_speed);
}
inline auto fields(robot_state_t& m) {
  return std::tie(m.utime, m.robot_id, m.origin, m.uid, m.program, m.phase, m.band, m.program_epoch,
                  m.program_start_utime, m.wheel_left, m.wheel_right, m.program_left,
                  m.program_right, m.light_front, m.light_back, m.ir, m.flags, m.command_seq,
                  m.command_instance, m.stop_seq, m.reversal_count, m.reversal_start_utime,
                  m.reversal_end_utime, m.tumble_count, m.run_time, m.senses_utime,
                  m.senses_since_utime, m.battery, m.link_sent, m.link_received, m.link_errors);
}
inline auto fields(link_peer_t& m) {
  return std::tie(m.host, m.instance, m.state, m.heard_utime, m.clock_offset, m.clock_error,
                  m.round_trip, m.sent, m.received, m.lost, m.repeated, m.stale, m.clashing,
                  m.trouble);
}
inline auto fields(link_status_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.host, m.allowed_clock_offset, m.foreign,
                  m.timeouts, m.num_peers, m.peers);
}
inline auto fields(motor_calibration_t& m) {
  return std::tie(m.robot_id, m.gain_left, m.gain_right, m.dead_band_left, m.dead_band_right,
                  m.wheel_base);
}
inline auto fields(robot_step_t& m) {
  return std::tie(m.utime, m.robot_id, m.draw_count, m.program_epoch, m.slot, m.phase, m.wheel_left,
                  m.wheel_right, m.duration, m.rng);
}
inline auto fields(sense_values_t& m) { return std::tie(m.robot_id, m.values); }
inline auto fields(stream_count_t& m) {
  return std::tie(m.channel, m.sender, m.instance, m.received, m.lost, m.decode_errors);
}
inline auto fields(tracked_pose_t& m) {
  return std::tie(m.robot_id, m.x, m.y, m.theta, m.covariance, m.confidence);
}
inline auto fields(true_pose_t& m) {
  return std::tie(m.robot_id, m.x, m.y, m.theta, m.program, m.contact_robot, m.contact_wall);
}

inline auto fields(analysis_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.robot_id, m.program, m.observed,
                  m.segments, m.reversals, m.contact_share, m.verdict, m.max_z, m.num_curves,
                  m.curves, m.num_estimates, m.estimates);
}
inline auto fields(clock_t& m) { return std::tie(m.utime, m.sender, m.instance, m.seq, m.rate); }
inline auto fields(collective_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.program, m.observed, m.robots,
                  m.num_observables, m.observables, m.num_curves, m.curves, m.num_members,
                  m.members);
}
inline auto fields(experiment_event_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.kind, m.text, m.contract_version,
                  m.fingerprints, m.version, m.step, m.label, m.commanded_utime, m.presented_utime,
                  m.seen_utime, m.first_acted_utime, m.last_acted_utime, m.robots_acted,
                  m.robots_expected, m.ended_by);
}
inline auto fields(experiment_command_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.action, m.value, m.text);
}
inline auto fields(experiment_status_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.run, m.phase, m.elapsed, m.left,
                  m.at_most, m.rate, m.jumps, m.step, m.label, m.step_left, m.stop, m.commander,
                  m.command_instance, m.command_seq, m.refusal);
}
inline auto fields(light_command_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.priority, m.from_utime, m.ramp,
                  m.hold_until_utime, m.release, m.label, m.num_layers, m.layers, m.num_drives,
                  m.drives);
}
inline auto fields(light_delivery_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.steps, m.num_delays, m.delays);
}
inline auto fields(light_seen_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.frame, m.level, m.sync);
}
inline auto fields(light_status_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.frame, m.frame_period, m.commander,
                  m.command_instance, m.command_seq, m.label, m.first_shown_utime, m.moving,
                  m.calibration_id, m.last_refusal, m.display, m.vsync, m.latency, m.sync,
                  m.trouble, m.tracker_instance, m.num_tracked_frames, m.tracked_frames, m.mix,
                  m.num_previous, m.previous, m.num_layers, m.layers);
}
inline auto fields(robot_calibration_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.num_robots, m.robots);
}
inline auto fields(robot_steps_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.num_steps, m.steps);
}
inline auto fields(robot_command_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.lease_ms, m.num_orders, m.orders);
}
inline auto fields(robot_senses_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.num_robots, m.robots);
}
inline auto fields(robot_status_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.num_robots, m.robots);
}
inline auto fields(robot_stop_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.clear, m.num_robots, m.robot_ids,
                  m.reason);
}
inline auto fields(service_status_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.state, m.origin, m.host, m.pid, m.version,
                  m.contract_version, m.start_utime, m.last_error, m.num_sent, m.sent,
                  m.num_received, m.received);
}
inline auto fields(sim_truth_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.collisions, m.num_robots, m.robots);
}
inline auto fields(tracked_frame_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.origin, m.frame, m.frame_period,
                  m.num_robots, m.robots, m.num_unidentified, m.unidentified);
}
inline auto fields(tracked_details_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.frame, m.num_caps, m.caps);
}
inline auto fields(tracker_status_t& m) {
  return std::tie(m.utime, m.sender, m.instance, m.seq, m.camera, m.state, m.trouble, m.width,
                  m.height, m.fps, m.exposure, m.gain, m.pixels, m.locked, m.calibration_id,
                  m.frames, m.dropped, m.dark, m.saturated, m.brightness, m.caps, m.unbound,
                  m.bindings, m.unbindings, m.flips, m.lost, m.spacings, m.spacing_error,
                  m.spacing_sigma, m.moved, m.warning, m.latency_p50, m.latency_p95, m.latency_p99);
}

/// Fills a message so that no two neighbours are equal: numbers count up, every array has `length`
/// elements. The field before an array is its count (LCM's rule).
class Filler {
 public:
  explicit Filler(std::size_t length) : length_(length) {}

  template <class Type>
  void operator()(Type& value) {
    if constexpr (std::is_arithmetic_v<Type>) {
      value = static_cast<Type>(++number_ % 120);
      if constexpr (std::integral<Type>) count_ = setter(value);
    } else if constexpr (std::same_as<Type, std::string>) {
      value = "text " + std::to_string(++number_);
    } else if constexpr (std::is_bounded_array_v<Type>) {
      for (auto& element : value) (*this)(element);
    } else if constexpr (kIsVector<Type>) {
      if (count_) count_(length_);
      value.resize(length_);
      const auto count = count_;
      for (auto& element : value) (*this)(element);
      count_ = count;  // curve_t: one count, several arrays
    } else {
      std::apply([this](auto&... field) { ((*this)(field), ...); }, fields(value));
    }
  }

 private:
  template <class Type>
  static constexpr bool kIsVector = requires(Type v) {
    v.push_back(v.front());
  }
  &&!std::same_as<Type, std::string>;
  template <class Integer>
  static std::function<void(std::size_t)> setter(Integer& value) {
    return [&value](std::size_t length) { value = static_cast<Integer>(length); };
  }

  std::size_t length_;
  std::uint32_t number_ = 0;
  std::function<void(std::size_t)> count_;
};

template <class Message>
Message sample(std::size_t length) {
  Message message{};
  Filler{length}(message);
  return message;
}

/// LCM's encoding by its specification: the fingerprint, then the fields in order, big endian,
/// strings with their length and a final 0, arrays without length.
class WireWriter {
 public:
  std::vector<std::uint8_t> bytes;

  template <class Type>
  void operator()(Type& value) {
    if constexpr (std::integral<Type>) {
      unsignedNumber(static_cast<std::make_unsigned_t<Type>>(value));
    } else if constexpr (std::same_as<Type, float>) {
      unsignedNumber(std::bit_cast<std::uint32_t>(value));
    } else if constexpr (std::same_as<Type, double>) {
      unsignedNumber(std::bit_cast<std::uint64_t>(value));
    } else if constexpr (std::same_as<Type, std::string>) {
      unsignedNumber(static_cast<std::uint32_t>(value.size() + 1));
      bytes.insert(bytes.end(), value.begin(), value.end());
      bytes.push_back(0);
    } else if constexpr (requires { std::begin(value); }) {
      for (auto& element : value) (*this)(element);
    } else {
      std::apply([this](auto&... field) { ((*this)(field), ...); }, fields(value));
    }
  }

  template <std::unsigned_integral Number>
  void unsignedNumber(Number number) {
    for (int shift = static_cast<int>(sizeof(Number)) * 8 - 8; shift >= 0; shift -= 8) {
      bytes.push_back(static_cast<std::uint8_t>(number >> shift));
    }
  }
};

}  // namespace lab
