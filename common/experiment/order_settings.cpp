#include "common/experiment/order_settings.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "common/files/experiment_error.hpp"
#include "common/files/file_text.hpp"
#include "common/files/file_values.hpp"
#include "common/programs/program.hpp"
#include "common/programs/program_file.hpp"
#include "common/text/printable.hpp"
#include "common/text/utf8.hpp"
#include "robot/dynamics/byte_code.hpp"

namespace lab {
namespace {

constexpr double kSlowestReversal = 1e-6;  // m/s

/// Light of 0..1 in counts of the robot's 10-bit converter, rounded as the converter does, so that
/// light on an edge belongs to the band above it. The upper edge 1 becomes 1024, because full light
/// reads 1023 and belongs to a band up to 1.
std::uint16_t counts(double light) {
  if (light >= 1) return dynamics::kLightCounts;
  return static_cast<std::uint16_t>(
      std::lround(std::clamp(light, 0.0, 1.0) * (dynamics::kLightCounts - 1)));
}

/// "robot 3", "robot 3 and 4 others"
std::string robotsOf(const robot_order_t& order) {
  if (order.robot_ids.empty()) return "no robot";
  std::string text = "robot " + std::to_string(order.robot_ids.front());
  if (order.robot_ids.size() > 1) {
    text += " and " + std::to_string(order.robot_ids.size() - 1) + " others";
  }
  return text;
}

/// Why the order's numbers other than its programs are wrong; empty if they are valid.
std::string numbersRefusal(const robot_order_t& order, const dynamics::WheelLimits& limits) {
  if (order.mode == robot_order_t::DRIVE) {
    const bool drivable = std::abs(order.wheel_left) <= limits.v_max &&
                          std::abs(order.wheel_right) <= limits.v_max;  // false for nan
    return drivable ? ""
                    : robotsOf(order) + ": wheel speeds beyond the wheels' limit, or not numbers";
  }
  if (order.light_sensor < robot_order_t::SENSOR_MEAN ||
      order.light_sensor > robot_order_t::SENSOR_BACK) {
    return "no light sensor has the number " + std::to_string(order.light_sensor);
  }
  const bool finite = std::isfinite(order.hysteresis) &&
                      std::all_of(order.bands.begin(), order.bands.end(), [](const auto& band) {
                        return std::isfinite(band.low) && std::isfinite(band.high);
                      });
  return finite ? "" : "a light band or the hysteresis is not a number";
}

/// Files are checked with the nominal distance between the wheels. That of a robot, from its
/// calibration, may exceed it by this factor; what is then faster than its wheels is limited and
/// counted.
constexpr double kWheelBaseTolerance = 1.1;
constexpr double kWheelBaseStep = 0.005;  // m; robots of one kind share the check of a text
constexpr std::size_t kTextsKept = 256;
constexpr std::size_t kLongestText = file_kinds::kProgram.most_bytes;  // with comments

/// The program's name for messages, where it may be any text.
std::string named(const program_t& program) {
  return "program \"" + printable(utf8Prefix(program.id.name, kLongestProgramName)) + "\"";
}

/// Why the text of the program would be refused in an experiment file; empty: it would not.
std::string checkText(const program_t& program, const dynamics::WheelLimits& limits) {
  const std::string who = named(program);
  try {
    const ProgramFile read = readProgram(program.text, who, program.id.name, limits);
    const bool same = read.compiled.code == program.code;
    return same ? ""
                : who + ": its text does not compile to its byte code; send both of one program";
  } catch (const ExperimentError& error) {
    return error.problems().front();
  }
}

/// The same, remembered: hundreds of robots get the same text.
std::string textRefusal(const program_t& program, const dynamics::WheelLimits& limits) {
  using Key = std::tuple<std::string, std::string, std::vector<std::uint8_t>, double, double>;
  thread_local std::map<Key, std::string> known;
  const double base = std::max(
      kWheelBaseStep,
      std::floor(limits.wheel_base / kWheelBaseTolerance / kWheelBaseStep) * kWheelBaseStep);
  const Key key{program.id.name, program.text, program.code, limits.v_max, base};
  if (const auto found = known.find(key); found != known.end()) return found->second;
  if (known.size() >= kTextsKept) known.clear();
  return known[key] = checkText(program, {limits.v_max, base});
}

/// Every report of a robot repeats the name of its program.
std::string nameRefusal(const program_t& program) {
  if (keys::isBareName(program.id.name, kLongestProgramName)) return "";
  return named(program) + ": found a name that no program of a file has, expected 1 to " +
         std::to_string(kLongestProgramName) +
         " letters, digits, _ and -, beginning with a letter or digit";
}

/// Why no robot can run the program; empty if one can.
std::string programRefusal(const program_t& program, const dynamics::WheelLimits& limits) {
  if (program.id.hash == 0 && program.code.empty()) {
    return program.id.name.empty() ? "" : nameRefusal(program);
  }
  const std::string who = named(program) + ": ";
  const auto size = static_cast<std::uint16_t>(std::min<std::size_t>(program.code.size(), 0xFFFF));
  const dynamics::ByteCodeCheck check = dynamics::checkByteCode(program.code.data(), size);
  if (check.fault != dynamics::kValidByteCode) {
    return who + "its byte code has fault " + std::to_string(check.fault) + " at byte " +
           std::to_string(check.position) +
           " (robot/dynamics/byte_code.hpp); send what this version's compiler writes";
  }
  const std::uint32_t hash =
      dynamics::programHash(program.code.data(), static_cast<std::uint8_t>(size));
  if (hash != program.id.hash) return who + "its hash is not that of its byte code";
  if (std::string refusal = nameRefusal(program); !refusal.empty()) return refusal;
  if (program.text.size() > kLongestText) {
    return who + "found a text of more than " + std::to_string(kLongestText) +
           " bytes, allowed at most " + std::to_string(kLongestText) + "; leave out its comments";
  }
  // Without a text there is nothing to check; what is too fast is then limited and counted.
  return program.text.empty() ? "" : textRefusal(program, limits);
}

/// What is too long stays too long.
program_t programToKeep(const program_t& program) {
  program_t kept{};
  kept.id.hash = program.id.hash;
  kept.id.name = program.id.name.substr(0, kLongestProgramName + 1);
  kept.text = program.text.substr(0, kLongestText + 1);
  const std::size_t size =
      std::min(program.code.size(), std::size_t{dynamics::kLargestProgram} + 1);
  kept.code.assign(program.code.begin(), program.code.begin() + static_cast<std::ptrdiff_t>(size));
  kept.size = static_cast<std::int16_t>(size);
  return kept;
}

}  // namespace

robot_order_t orderToKeep(const robot_order_t& order, std::int32_t robot_id) {
  robot_order_t kept{};
  kept.robot_ids = {robot_id};
  kept.num_robots = 1;
  kept.mode = order.mode;
  kept.wheel_left = order.wheel_left;
  kept.wheel_right = order.wheel_right;
  kept.light_sensor = order.light_sensor;
  kept.hysteresis = order.hysteresis;
  kept.reverse_on = order.reverse_on;
  kept.reverse_distance = order.reverse_distance;
  kept.reverse_speed = order.reverse_speed;
  for (const light_band_t& band : order.bands) {
    light_band_t& copy = kept.bands.emplace_back();
    copy.low = band.low;
    copy.high = band.high;
    // More bands than this are refused for their number.
    if (kept.bands.size() <= dynamics::kSlots) copy.program = programToKeep(band.program);
  }
  kept.num_bands = static_cast<std::int8_t>(kept.bands.size());
  return kept;
}

OrderSettings settingsFrom(const robot_order_t& order, const dynamics::WheelLimits& limits,
                           double sensor_period) {
  OrderSettings result;
  result.core.max_wheel_um_s = static_cast<std::int32_t>(std::lround(limits.v_max * 1e6));
  result.core.half_wheel_base_um =
      static_cast<std::int32_t>(std::lround(limits.wheel_base / 2 * 1e6));
  result.core.sensor_period_ms = static_cast<std::uint16_t>(std::lround(sensor_period * 1e3));
  result.refusal = numbersRefusal(order, limits);
  if (!result.refusal.empty() || order.mode != robot_order_t::TABLE) return result;
  if (order.bands.size() > dynamics::kSlots) {
    result.refusal =
        "a robot holds at most 4 light bands, this order has " + std::to_string(order.bands.size());
    return result;
  }
  dynamics::LightSettings& light = result.core.light;
  light.count = static_cast<std::uint8_t>(order.bands.size());
  light.hysteresis = static_cast<std::uint16_t>(
      std::lround(std::clamp(order.hysteresis, 0.0, 1.0) * (dynamics::kLightCounts - 1)));
  light.reading = static_cast<dynamics::LightReading>(order.light_sensor);
  for (std::uint8_t slot = 0; slot < light.count; ++slot) {
    const light_band_t& band = order.bands[slot];
    result.refusal = programRefusal(band.program, limits);
    if (!result.refusal.empty()) return result;
    light.bands[slot] = {counts(band.low), counts(band.high), slot};
    result.core.programs[slot] = static_cast<std::uint32_t>(band.program.id.hash);
    result.programs.push_back(programToKeep(band.program));
    result.programs.back().text.clear();
  }
  if (!dynamics::isValid(light)) {
    result.refusal = "light bands overlap, are empty or leave 0..1";
    return result;
  }
  result.core.reversal.enabled = order.reverse_on != robot_order_t::REVERSE_NEVER;
  if (result.core.reversal.enabled) {
    // The robot counts whole micrometres per second: less than one would be none.
    if (!(order.reverse_speed >= kSlowestReversal && order.reverse_speed <= limits.v_max &&
          order.reverse_distance >= 0 && order.reverse_distance <= 4)) {
      result.refusal = "a reversal needs a speed up to the wheels' limit and at most 4 m";
      return result;
    }
    result.core.reversal.distance_um =
        static_cast<std::uint32_t>(std::lround(order.reverse_distance * 1e6));
    result.core.reversal.speed_um_s =
        static_cast<std::int32_t>(std::lround(order.reverse_speed * 1e6));
  }
  return result;
}

}  // namespace lab
