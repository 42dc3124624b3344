#include "common/experiment/experiment_describe.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "common/experiment/description_line.hpp"
#include "common/experiment/experiment_log_size.hpp"
#include "common/experiment/experiment_reach.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/experiment/script_plan.hpp"
#include "common/files/file_values.hpp"
#include "common/text/format.hpp"
#include "light/field/field.hpp"

namespace lab {
namespace {

using description::line;
using keys::centimetreText;
using keys::fileText;
using keys::numberText;
using keys::unitOf;

constexpr int kParameterDigits = 6;

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string parameters(const Program& program) {
  std::string text = program.description;
  for (const ProgramParameter& parameter : program.parameters) {
    text += (text.empty() ? "" : ", ") + parameter.name + " = " +
            quantityText(parameter.value, parameter.unit, kParameterDigits);
  }
  return text;
}

/// A warning if a parameter is a time of more than a third of the run. Its value was probably meant
/// in ms.
std::string slowness(const Program& program, double duration) {
  for (const ProgramParameter& parameter : program.parameters) {
    const bool rate = parameter.unit == "1/s" && parameter.value > 0;
    if (!rate && parameter.unit != "s") continue;
    const double time = rate ? 1 / parameter.value : parameter.value;
    if (time <= duration / 3) continue;
    return (rate ? "1/" : "") + parameter.name + " = " + rounded(time) +
           " s is more than a third of the run: too few draws for any law (it is in s)";
  }
  return {};
}

std::string describePrograms(const Experiment& e, const ProgramCoefficients& coefficients) {
  std::string text;
  for (const auto& [name, program] : e.programs) {
    text += line("program", name + ": " + parameters(program));
    std::string more = coefficients ? coefficients(program) : "";
    more += (more.empty() ? "" : "; ") + std::string("fastest wheel ") +
            rounded(program.fastest_wheel * 100) + " of " +
            centimetreText(e.hardware.max_wheel_speed) + " cm/s";
    text += line("", "  " + more);
    for (const std::string& warning : program.warnings) {
      text += line("", "  warning: " + warning);
    }
    if (const std::string slow = slowness(program, e.duration); !slow.empty()) {
      text += line("", "  " + slow);
    }
  }
  return text;
}

std::string ids(const std::vector<RobotSpec>& robots) {
  std::string text;
  for (std::size_t first = 0; first < robots.size();) {
    std::size_t last = first;
    while (last + 1 < robots.size() && robots[last + 1].id == robots[last].id + 1) ++last;
    text += (text.empty() ? "" : ", ") + std::to_string(robots[first].id);
    if (last > first) text += " to " + std::to_string(robots[last].id);
    first = last + 1;
  }
  return text;
}

/// "18 simulated (3 to 20), 0 at given and 18 at random places"
std::string describeBody(const Experiment& e, Body body, const std::string& what) {
  std::vector<RobotSpec> robots;
  std::ranges::copy_if(e.robots, std::back_inserter(robots),
                       [body](const RobotSpec& robot) { return robot.body == body; });
  if (robots.empty()) return {};
  std::string text = std::to_string(robots.size()) + ' ' + what + " (" + ids(robots) + ")";
  if (isSimulated(body)) {
    const auto placed = std::ranges::count_if(
        robots, [](const RobotSpec& robot) { return robot.start.has_value(); });
    const auto random = static_cast<std::ptrdiff_t>(robots.size()) - placed;
    text += ", " + std::to_string(placed) + " at given and " + std::to_string(random) +
            " at random places";
  }
  return line("robots", text);
}

std::string describeRobots(const Experiment& e) {
  return describeBody(e, Body::kSim, "simulated") +
         describeBody(e, Body::kWire, "simulated on the wire") +
         describeBody(e, Body::kFirmware, "running the firmware on a simulated chip") +
         describeBody(e, Body::kSerial, "real, on " + e.serial.ports) +
         describeBody(e, Body::kReplay, "replayed") +
         (e.robots.size() > kMostLiveRobots
              ? line("", "  more than " + std::to_string(kMostLiveRobots) +
                             ": in virtual time only (--virtual-time)")
              : "");
}

std::string describeTable(const LightTable& table) {
  const char* sensor = table.sensor == LightSensor::kMean    ? "mean of both sensors"
                       : table.sensor == LightSensor::kFront ? "front sensor"
                                                             : "back sensor";
  std::string text =
      line("light table", std::string(sensor) + ", hysteresis " + numberText(table.hysteresis));
  for (const LightBand& band : table.bands) {
    text += line(
        "", "  " + numberText(band.low) + " to " + numberText(band.high) + ": " + band.program);
  }
  return text;
}

/// The program that this light selects, without hysteresis.
std::string programIn(const LightTable& table, double light) {
  for (const LightBand& band : table.bands) {
    if (contains(band, light)) return band.program;
  }
  return "no band (robots stand)";
}

/// The range of light, and the fraction of the arena where each program is selected.
std::string shares(const Experiment& e, const LightStep& step) {
  constexpr int kColumns = 48;
  constexpr int kRows = 36;
  light::Field field;
  bool changes = false;
  bool for_robots = false;
  for (const LayerSpec& layer : step.layers) {
    if (!layer.image.empty()) return "as the image " + layer.image + " says";
    const light::Drive& drive = layer.drive;
    if (drive.follow != light::Follow::kNothing || drive.gate != light::Gate::kOpen) {
      for_robots = true;
      continue;
    }
    changes = changes || !light::isStill(drive);
    field.layers.push_back(light::driven({toLightLayer(layer), drive}, 0));
  }
  const light::CompiledField compiled(field);
  std::map<std::string, int> pixels;
  double low = 1;
  double high = 0;
  for (int pixel = 0; pixel < kColumns * kRows; ++pixel) {
    const int column = pixel % kColumns;
    const int row = pixel / kColumns;
    const double x = (column + 0.5) / kColumns * e.arena_width;
    const double y = (row + 0.5) / kRows * e.arena_height;
    const double light = compiled.evaluate(x, y);
    ++pixels[programIn(e.light_table, light)];
    low = std::min(low, light);
    high = std::max(high, light);
  }
  std::string text = "light " + rounded(low);
  if (high > low) text += " to " + rounded(high);
  for (const auto& [program, count] : pixels) {
    text += ", " + program;
    if (pixels.size() > 1)
      text += ' ' + rounded(std::round(100.0 * count / (kColumns * kRows))) + " %";
  }
  if (changes) text += " at its start; it changes with time";
  if (for_robots) text += "; without layers that depend on robots";
  return text;
}

bool hasCondition(const std::vector<LightStep>& steps) {
  return std::ranges::any_of(steps, [](const LightStep& step) { return step.until.given(); });
}

/// The condition that ends a step, and where the script continues.
std::string describeEnd(const LightStep& step) {
  std::string text;
  if (step.until.given()) {
    const char* otherwise = step.if_not == IfNot::kNext  ? "the script goes on"
                            : step.if_not == IfNot::kEnd ? "the run ends"
                                                         : "the safe light, and the run ends";
    text += "; until " + conditionText(step.until) + ", at most " + numberText(step.hold) +
            " s, if not: " + otherwise;
  }
  if (!step.back_to.empty()) {
    text += "; back to \"" + step.back_to + "\", " + std::to_string(step.times) + " times in all";
  }
  return text;
}

std::string describeLight(const Experiment& e) {
  std::string head = std::to_string(e.light.steps.size());
  head += e.light.steps.size() == 1 ? " step" : " steps";
  const std::string at_most = hasCondition(e.light.steps) ? "at most " : "";
  if (e.light.repeat) head += ", again every " + at_most + numberText(e.light.length) + " s";
  std::string text = line("light", head);
  bool open = false;  // whether an earlier step may end early
  for (const LightStep& step : e.light.steps) {
    std::string what =
        (open ? "  by " : "  ") + numberText(step.at) + " s " + step.label + ": " + shares(e, step);
    if (step.ramp > 0) what += ", fading in for " + numberText(step.ramp) + " s";
    if (step.at >= e.duration) what += " (after the run's end)";
    what += describeEnd(step);
    open = open || step.until.given();
    text += line("", what);
  }
  return text;
}

std::string describeSenses(const Senses& senses) {
  if (senses.values.empty()) return {};
  std::string text = line(
      "senses", rounded(senses.rate) + " times per second, " +
                    (senses.delay > 0
                         ? numberText(senses.delay * 1000) + " ms after the exposure of the frame"
                         : "as soon as the tracker has the poses"));
  for (const SenseSpec& sense : senses.values) {
    text += line("", "  sense(" + std::to_string(sense.index) + "): " + senseText(sense));
  }
  return text;
}

std::string describeReversal(const Reversal& reversal) {
  if (reversal.on == ReverseOn::kNever) return line("reversal", "never");
  return line("reversal", std::string("from walls") +
                              (reversal.on == ReverseOn::kAny ? " and robots" : "") + ", " +
                              centimetreText(reversal.distance) + " cm back at " +
                              centimetreText(reversal.speed) + " cm/s");
}

std::string describeSize(double bytes) {
  if (bytes < 1e9) return rounded(std::ceil(bytes / 1e6)) + " MB";
  return bytes < 1e12 ? rounded(bytes / 1e9) + " GB" : rounded(bytes / 1e12) + " TB";
}

std::string describeFilm(const Camera& camera, bool several) {
  if (!camera.film.record) return {};
  const FilmSpec& film = camera.film;
  const std::string codec = film.codec == FilmCodec::kFfv1 ? "ffv1, lossless"
                            : film.codec == FilmCodec::kFfvhuff
                                ? "ffvhuff, lossless"
                                : "h264, crf " + std::to_string(film.crf);
  return line("film", codec + ", at most " + describeSize(film.most_GB * 1e9) +
                          (several ? " for all cameras" : ""));
}

std::string pictureText(const Camera& camera) {
  return std::to_string(camera.width) + " x " + std::to_string(camera.height) + " pixels, " +
         (isPainted(camera) ? "simulated" : camera.source) +
         (camera.calibration.empty() ? "" : ", " + camera.calibration);
}

std::string describeCamera(const Experiment& e) {
  const Camera& camera = e.camera;
  const std::string frames = numberText(camera.fps) + " frames/s, " +
                             numberText(std::floor(camera.fps * e.duration)) + " frames, ";
  if (!e.cameras.empty()) {
    std::string text = line("cameras", frames + std::to_string(e.cameras.size()) + " cameras");
    for (const Camera& one : camerasOf(e)) {
      text += line("", "  " + one.name + ": " + pictureText(one) + ", sees " +
                           centimetreText(one.view.width) + " cm x " +
                           centimetreText(one.view.height) + " cm from (" +
                           centimetreText(one.view.x) + ", " + centimetreText(one.view.y) + ") cm");
    }
    return text + describeFilm(camera, true);
  }
  if (camera.tracker == Tracker::kCamera) {
    return line("camera", frames + pictureText(camera)) + describeFilm(camera, false);
  }
  return line("camera", frames + "noise " + centimetreText(camera.position_noise) + " cm and " +
                            fileText(camera.heading_noise, unitOf("_deg")) + " degrees");
}

std::string describeStop(const Experiment& e) {
  std::string text;
  for (const StopRule& rule : e.stop_when) {
    const bool first = text.empty();
    std::string what = first ? "" : e.stop_on == StopOn::kAll ? "and " : "or ";
    what += conditionText(rule.until);
    if (rule.at_least > 0) what += ", not before " + numberText(rule.at_least) + " s";
    text += line(first ? "stop when" : "", what);
  }
  return text;
}

}  // namespace

std::string senseText(const SenseSpec& sense) {
  const std::string radius = centimetreText(sense.radius) + " cm";
  const std::string place =
      "the place (" + centimetreText(sense.x) + ", " + centimetreText(sense.y) + ") cm";
  switch (sense.kind) {
    case SenseKind::kNeighbours:
      return "neighbours within " + radius;
    case SenseKind::kDensity:
      return "density within " + radius;
    case SenseKind::kMeanHeading:
      return "mean heading within " + radius + " (rad)";
    case SenseKind::kNearestDistance:
      return "distance of the nearest robot within " + radius + " (cm)";
    case SenseKind::kNearestBearing:
      return "bearing of the nearest robot within " + radius + " (rad)";
    case SenseKind::kPlaceDistance:
      return "distance of " + place + " (cm)";
    case SenseKind::kPlaceBearing:
      return "bearing of " + place + " (rad)";
    case SenseKind::kGradient:
      return "gradient of the light (1/cm)";
    case SenseKind::kGradientBearing:
      return "bearing of the light's gradient (rad)";
    case SenseKind::kExpression:
      return sense.value;
  }
  return {};
}

/// What the host writes for programs.

std::string describeExperiment(const Experiment& e, const ProgramCoefficients& coefficients) {
  std::string text =
      line("experiment", e.name + (e.description.empty() ? "" : ": ") + e.description);
  const std::string at_most = mayEndEarly(e) ? "at most " : "";
  text += line("run", at_most + numberText(e.duration) + " s, seed " + std::to_string(e.seed));
  text += describeStop(e);
  text += line("arena",
               centimetreText(e.arena_width) + " cm x " + centimetreText(e.arena_height) + " cm");
  text += describeRobots(e);
  text += describePrograms(e, coefficients);
  text += describeSenses(e.senses);
  text += describeTable(e.light_table);
  text += describeLight(e);
  text += describeReversal(e.reversal);
  text += describeCamera(e);
  text += describeReach(e);
  text += line("log", at_most + "about " + describeSize(expectedLogBytes(e)));
  return text;
}

}  // namespace lab
