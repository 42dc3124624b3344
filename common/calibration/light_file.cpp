#include "common/calibration/light_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/experiment/experiment_messages.hpp"
#include "common/files/file_text.hpp"
#include "common/files/json_section.hpp"
#include "common/math/units.hpp"
#include "light/field/drive.hpp"

namespace lab {
namespace {

constexpr const char* kLightForm = "active-lab light 1";
constexpr double kSameLength = 1e-4;      // [m] of an arena's side
constexpr double kNarrowestBand = 0.005;  // [1] five steps of the converter

/// Checks that the light bands are wide enough for every robot's sensors.
void checkBands(const Experiment& experiment, const LightCalibration& calibration,
                const std::string& file) {
  const robot_command_t table = withCalibratedBands(lightTableCommand(experiment), calibration);
  for (const robot_order_t& order : table.orders) {
    for (std::size_t i = 0; i < order.bands.size(); ++i) {
      if (order.bands[i].high - order.bands[i].low >= kNarrowestBand) continue;
      const LightBand& band = experiment.light_table.bands[i];
      throw ExperimentError(
          {fmt::format("{}: robot {} would read {:.3f} to {:.3f} in the band {:g} to {:g} of {}, "
                       "needed are {:g} "
                       "between the two; lower the band, or mend what its sensors see of the light",
                       file, order.robot_ids.front(), order.bands[i].low, order.bands[i].high,
                       band.low, band.high, band.program, kNarrowestBand)});
    }
  }
}

/// Robots need only the byte code, and a message has room for few texts.
void leaveOutTheText(program_t& program) {
  program.text.clear();
  program.parameters.clear();
  program.num_parameters = 0;
}

}  // namespace

double LightCalibration::reading(std::int32_t robot, LightSensor sensor, double intensity) const {
  const auto found = gains.find(robot);
  const SensorGains own = found != gains.end() ? found->second : SensorGains{};
  const double gain = sensor == LightSensor::kFront  ? own.front
                      : sensor == LightSensor::kBack ? own.back
                                                     : (own.front + own.back) / 2;
  return gain * (ambient + scale * tone().weakest() * intensity);
}

robot_command_t withCalibratedBands(const robot_command_t& command,
                                    const LightCalibration& calibration) {
  robot_command_t out = command;
  out.orders.clear();
  for (const robot_order_t& order : command.orders) {
    bool own_is_a_copy = false;
    for (const std::int32_t robot : order.robot_ids) {
      robot_order_t own = order;
      own.robot_ids = {robot};
      own.num_robots = 1;
      const auto sensor = static_cast<LightSensor>(own.light_sensor);
      const auto reading = [&](double light) {
        // The ends of the table mean any light below or above, whatever the sensor reads.
        if (light <= 0) return 0.0;
        if (light >= 1) return 1.0;
        return std::clamp(calibration.reading(robot, sensor, light), 0.0, 1.0);
      };
      for (light_band_t& band : own.bands) {
        band.low = reading(band.low);
        band.high = reading(band.high);
      }
      own.hysteresis *=
          calibration.reading(robot, sensor, 1) - calibration.reading(robot, sensor, 0);
      if (own_is_a_copy) {
        for (light_band_t& band : own.bands) leaveOutTheText(band.program);
      }
      own_is_a_copy = true;
      out.orders.push_back(std::move(own));
    }
  }
  out.num_orders = static_cast<std::int32_t>(out.orders.size());
  return out;
}

LightCalibration readLightFile(const std::filesystem::path& path) {
  return parseLightFile(path.string(), readFileText(path, file_kinds::kCalibration));
}

LightCalibration parseLightFile(const std::string& name, const std::string& text) {
  const nlohmann::json root =
      parseJson(name, text, "a calibration of light (lab calibrate light writes one)");
  const JsonSection file(name, "docs/photometry.md lists the keys", root);
  if (!file.has("form") || file.text("form") != kLightForm) {
    file.fail("",
              fmt::format("is no calibration of light: found no \"form\": \"{}\"; lab calibrate "
                          "light writes one",
                          kLightForm));
  }
  LightCalibration calibration;
  calibration.gamma = file.number("gamma", 0.1, 10);
  calibration.vignetting = file.numbers<5>("vignetting");
  calibration.scale = file.number("scale", 1e-6, 1e3);
  calibration.ambient = file.number("ambient", -1, 1);
  calibration.residual = file.number("residual", 0, 1);
  const JsonSection arena = file.section("arena");
  calibration.arena_width = arena.number("width_m", 0.01, 100);
  calibration.arena_height = arena.number("height_m", 0.01, 100);
  const JsonSection sensors = file.section("sensors");
  for (const auto& [key, value] : root.at("sensors").items()) {
    const bool digits =
        !key.empty() && key.size() <= 5 && key.find_first_not_of("0123456789") == std::string::npos;
    if (!digits || std::stoi(key) > light::kLargestRobot) {
      file.fail("sensors", "found the robot \"" + key + "\", expected its number");
    }
    const JsonSection robot = sensors.section(key.c_str());
    calibration.gains[std::stoi(key)] = {robot.number("front", 0.01, 100),
                                         robot.number("back", 0.01, 100)};
  }
  calibration.id = fileId(text);
  return calibration;
}

std::string lightFileText(const LightCalibration& calibration) {
  nlohmann::ordered_json sensors = nlohmann::ordered_json::object();
  for (const auto& [robot, gains] : calibration.gains) {
    sensors[std::to_string(robot)] = {{"front", gains.front}, {"back", gains.back}};
  }
  const nlohmann::ordered_json file = {
      {"form", kLightForm},
      {"gamma", calibration.gamma},
      {"vignetting", calibration.vignetting},
      {"scale", calibration.scale},
      {"ambient", calibration.ambient},
      {"sensors", sensors},
      {"residual", calibration.residual},
      {"arena", {{"width_m", calibration.arena_width}, {"height_m", calibration.arena_height}}}};
  return file.dump(2) + "\n";
}

std::optional<LightCalibration> activeLightCalibration(const Experiment& experiment,
                                                       const std::filesystem::path& directory) {
  if (experiment.projector.light_calibration.empty()) return std::nullopt;
  const std::filesystem::path path = directory / experiment.projector.light_calibration;
  LightCalibration found = readLightFile(path);
  if (std::abs(found.arena_width - experiment.arena_width) > kSameLength ||
      std::abs(found.arena_height - experiment.arena_height) > kSameLength) {
    throw ExperimentError({fmt::format(
        "{}: found a calibration of an arena of {:.2f} x {:.2f} cm, expected {:.2f} x {:.2f} cm as "
        "in "
        "the experiment; calibrate again",
        path.string(), found.arena_width / units::kCentimetre,
        found.arena_height / units::kCentimetre, experiment.arena_width / units::kCentimetre,
        experiment.arena_height / units::kCentimetre)});
  }
  checkBands(experiment, found, path.string());
  return found;
}

}  // namespace lab
