#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "common/experiment_check.hpp"
#include "common/experiment_cores.hpp"
#include "common/experiment_keys.hpp"
#include "common/file_values.hpp"
#include "light/image.hpp"

namespace lab::keys {
namespace {

/// Some ten steps of the robot's converter.
constexpr double kNarrowestBand = 0.01;  // [1]

std::string bandPath(std::size_t index) {
  return "light_table.bands[" + std::to_string(index) + "]";
}

std::string bandText(const LightBand& band) {
  return '[' + numberText(band.low) + ", " + numberText(band.high) + "]";
}

std::string programList(const ExperimentForm& form) {
  std::string list;
  for (const auto& [name, program] : form.common.programs) {
    list += (list.empty() ? "" : ", ") + tomlString(name);
  }
  return list;
}

void checkProgramName(const ExperimentForm& form, const std::string& path, const std::string& name,
                      Problems& problems) {
  if (problems.concern("programs") || form.common.programs.contains(name)) return;
  problems.add(
      path, "found " + tomlString(name) + ", allowed the name of a program: " + programList(form));
}

/// The largest hysteresis that leaves of every band a part which only this band can hold, so that
/// light there selects its program whatever ran before.
double widestHysteresis(std::vector<LightBand> bands) {
  std::ranges::sort(bands, {}, &LightBand::low);
  double widest = 1;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const bool lower = i > 0;
    const bool upper = i + 1 < bands.size();
    if (lower) widest = std::min(widest, bands[i].high - bands[i - 1].high);
    if (upper) widest = std::min(widest, bands[i + 1].low - bands[i].low);
    if (lower && upper) widest = std::min(widest, (bands[i + 1].low - bands[i - 1].high) / 2);
  }
  return widest;
}

void checkBands(const std::vector<LightBand>& bands, Problems& problems) {
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const LightBand& band = bands[i];
    if (!(band.high - band.low >= kNarrowestBand * (1 - 1e-9))) {
      problems.add(bandPath(i) + ".light", "found " + bandText(band) +
                                               ", allowed [low, high] with high at least " +
                                               numberText(kNarrowestBand) + " above low");
      continue;
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (band.low < bands[j].high && bands[j].low < band.high) {
        problems.add(bandPath(i) + ".light", "found " + bandText(band) + ", which overlaps " +
                                                 bandText(bands[j]) + " of " + bandPath(j) +
                                                 ", allowed bands that at most touch");
        break;
      }
    }
  }
}

void checkTable(const ExperimentForm& form, Problems& problems) {
  const LightTable& table = form.common.light_table;
  if (problems.concern("light_table.bands")) return;
  if (table.bands.empty()) {
    problems.add("light_table.bands",
                 "found none, allowed 1 to 4, as bands = [{light = [0, 1], "
                 "program = \"NAME\"}], or program = \"NAME\" at the top of "
                 "the file");
    return;
  }
  for (std::size_t i = 0; i < table.bands.size(); ++i) {
    checkProgramName(form, bandPath(i) + ".program", table.bands[i].program, problems);
  }
  checkBands(table.bands, problems);
  if (problems.concern("light_table")) return;
  const double widest = widestHysteresis(table.bands);
  if (table.bands.size() > 1 && table.hysteresis >= widest) {
    problems.add("light_table.hysteresis",
                 "found " + numberText(table.hysteresis) + ", allowed below " +
                     numberText(std::round(widest * 1e9) / 1e9) +
                     " (a band is kept this far beyond its edges: more would reach across the "
                     "whole of a neighbour, which the light could then not select)");
  }
}

std::string stepPath(std::size_t index) { return "light.steps[" + std::to_string(index) + "]"; }

bool checkStepForms(const ExperimentForm& form, Problems& problems) {
  const bool holds = form.light_steps.front().hold.has_value();
  const std::string allowed = holds ? "hold_s alone, as in light.steps[0]"
                                    : "at_s alone, as in light.steps[0] (or hold_s in all steps)";
  bool fine = true;
  for (std::size_t i = 0; i < form.light_steps.size(); ++i) {
    const StepEntry& step = form.light_steps[i];
    if (step.at.has_value() != holds && step.hold.has_value() == holds) continue;
    std::string found = "neither at_s nor hold_s";
    if (step.at) found = "at_s";
    if (step.hold) found = step.at ? "both at_s and hold_s" : "hold_s";
    problems.add(stepPath(i),
                 "found " + found + ", allowed " + (i == 0 ? "either at_s or hold_s" : allowed));
    fine = false;
    if (i == 0) break;
  }
  return fine;
}

void checkLength(const ExperimentForm& form, Problems& problems) {
  const bool holds = form.light_steps.front().hold.has_value();
  const bool repeat = form.common.light.repeat;
  if (form.light_length && (!repeat || holds)) {
    problems.add("light.length_s", "found " + numberText(*form.light_length) + ", allowed only " +
                                       (holds ? "where steps have at_s" : "with repeat = true"));
  } else if (repeat && !holds && !form.light_length) {
    problems.add("light.repeat",
                 "found true, allowed with length_s (when does the last step "
                 "end?), or with hold_s in all steps");
  }
}

void checkStepTimes(const ExperimentForm& form, Problems& problems) {
  const std::vector<double> times = stepTimes(form);
  const bool repeat = form.common.light.repeat;
  const bool holds = form.light_steps.front().hold.has_value();
  const double duration = form.common.duration;
  for (std::size_t i = 0; i < form.light_steps.size(); ++i) {
    const StepEntry& step = form.light_steps[i];
    const std::string key = stepPath(i) + (holds ? ".hold_s" : ".at_s");
    const std::string found = "found " + numberText(times[i]) + ", allowed ";
    if (i == 0 && times[i] != 0) {
      problems.add(key, found + "0: the first step begins with the run");
    } else if (i > 0 && !(times[i] > times[i - 1])) {
      problems.add(key, found + "above " + numberText(times[i - 1]) +
                            ", the at_s of the step "
                            "before");
    } else if (!repeat && !problems.concern("duration_s") && times[i] >= duration) {
      problems.add(key, "found a step that begins at " + numberText(times[i]) +
                            " s, allowed below duration_s = " + numberText(duration) +
                            " (or repeat = true)");
    } else if (times[i + 1] > times[i] && step.ramp > times[i + 1] - times[i]) {
      problems.add(stepPath(i) + ".ramp_s", "found " + numberText(step.ramp) + ", allowed 0 to " +
                                                fileText(times[i + 1] - times[i], unitOf("")) +
                                                ", as long as the step");
    }
  }
  if (form.light_length && *form.light_length <= times[times.size() - 2]) {
    problems.add("light.length_s", "found " + numberText(*form.light_length) + ", allowed above " +
                                       numberText(times[times.size() - 2]) +
                                       ", the at_s of the last step");
  }
}

/// The key of a light::Layer's field: the last one of the kind in the file's order.
std::string keyOf(const std::string& field, light::LayerKind kind) {
  using enum light::LayerKind;
  if (field == "size") {
    if (kind == kLinearGradient) return "length_cm";
    if (kind == kImage) return "width_cm";
    return kind == kStripes || kind == kChecker ? "period_cm" : "radius_cm";
  }
  if (field == "inner") {
    if (kind == kImage) return "height_cm";
    return kind == kStripes ? "share" : "inner_radius_cm";
  }
  if (field == "softness") return "softness_cm";
  if (field == "angle") return "angle_deg";
  if (field == "x" || field == "y") return field + "_cm";
  return field;
}

/// "above 0 and below size = 0.1 m" in the words and the unit of the file.
std::string inCentimetres(std::string text, light::LayerKind kind) {
  if (const std::size_t size = text.find("size"); size != std::string::npos) {
    text.replace(size, 4, keyOf("size", kind));
  }
  std::istringstream words(text);
  std::vector<std::string> result;
  for (std::string word; words >> word;) {
    const bool metres = (word == "m" || word == "m,") && !result.empty();
    if (metres)
      result.back() = fileText(std::strtod(result.back().c_str(), nullptr), unitOf("_cm"));
    result.push_back(metres ? "c" + word : word);
  }
  std::string sentence;
  for (const std::string& word : result) sentence += (sentence.empty() ? "" : " ") + word;
  return sentence;
}

void checkImage(const std::string& path, const std::filesystem::path& directory,
                light::Layer& layer, const std::string& name, Problems& problems) {
  const std::filesystem::path file = directory / name;
  std::error_code error;
  std::string why = "no such file";
  if (std::filesystem::is_regular_file(file, error)) {
    const light::DecodedImage decoded = light::loadImage(file);
    if (decoded.image) {
      layer.pixels = decoded.image;
      layer.image = decoded.image->sha256;
      return;
    }
    why = decoded.error.substr(decoded.error.starts_with(file.string()) ? file.string().size() : 0);
    why = why.starts_with(": ") ? why.substr(2) : why;
  }
  problems.add(path + ".file", "found " + tomlString(name) + " (" + why +
                                   "), allowed an image file beside the experiment file");
}

void checkLayer(const std::string& path, const LayerSpec& spec,
                const std::optional<std::filesystem::path>& directory, Problems& problems) {
  light::Layer layer = toLightLayer(spec);
  if (layer.kind == light::LayerKind::kImage) {
    if (!directory) return;
    checkImage(path, *directory, layer, spec.image, problems);
    if (problems.concern(path)) return;
  }
  const std::optional<std::string> problem = light::validate(layer);
  if (!problem) return;
  const std::size_t equals = problem->find(" = ");
  const std::string key = keyOf(problem->substr(0, equals), layer.kind);
  const std::string what = equals == std::string::npos ? *problem : problem->substr(equals + 3);
  problems.add(path + "." + key, "found " + inCentimetres(what, layer.kind));
}

void checkScript(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                 Problems& problems) {
  if (problems.concern("light.steps")) return;
  if (form.light_steps.empty()) {
    problems.add("light.steps", "found none, allowed at least one [[light.steps]]");
    return;
  }
  for (std::size_t i = 0; i < form.light_steps.size(); ++i) {
    const StepEntry& step = form.light_steps[i];
    for (std::size_t j = 0; j < step.layers.size(); ++j) {
      LayerSpec layer = step.layers[j].layer;
      layer.x = step.layers[j].x.value_or(0);
      layer.y = step.layers[j].y.value_or(0);
      checkLayer(stepPath(i) + ".layers[" + std::to_string(j) + "]", layer, directory, problems);
    }
  }
  if (!checkStepForms(form, problems)) return;
  checkLength(form, problems);
  checkStepTimes(form, problems);
}

}  // namespace

void checkShorthand(const ExperimentForm& form, Problems& problems) {
  if (form.program.empty()) return;
  checkProgramName(form, "program", form.program, problems);
  if (!form.common.light_table.bands.empty()) {
    problems.add("program", "found " + tomlString(form.program) +
                                " next to light_table.bands, allowed one of the two");
  }
}

void checkLight(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                Problems& problems) {
  if (!problems.concern("program")) checkTable(form, problems);
  checkScript(form, directory, problems);
}

}  // namespace lab::keys
