#include "common/experiment/checks/layer_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/experiment/checks/observable_checks.hpp"
#include "common/experiment/checks/program_checks.hpp"
#include "common/experiment/keys/experiment_keys.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/files/file_values.hpp"
#include "common/files/image_file.hpp"
#include "light/field/image.hpp"

namespace lab::keys {
namespace {

/// The key that holds a field of light::Layer, for this kind of layer.
std::string keyOf(const std::string& field, light::LayerKind kind) {
  using enum light::LayerKind;
  if (field == "size") {
    if (kind == kLinearGradient) return "length_cm";
    if (kind == kImage) return "width_cm";
    if (kind == kNoise) return "patch_cm";
    return kind == kStripes || kind == kChecker || kind == kWave ? "period_cm" : "radius_cm";
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

/// The key that holds a field of light::Drive.
std::string keyOfDrive(const std::string& field) {
  constexpr std::array<std::pair<const char*, const char*>, 13> kKeys = {
      {{"vx", "vx_cm_s"},
       {"vy", "vy_cm_s"},
       {"spin", "spin_deg_s"},
       {"period", "period_s"},
       {"image_rate", "images_per_s"},
       {"images", "files"},
       {"stale", "stale_s"},
       {"rate", "rate_per_s"},
       {"decay", "decay_per_s"},
       {"diffusion", "diffusion_cm2_s"},
       {"gate_x", "gate_x_cm"},
       {"gate_y", "gate_y_cm"},
       {"gate_radius", "gate_radius_cm"}}};
  const auto* const key =
      std::ranges::find(kKeys, field, [](const auto& pair) { return std::string(pair.first); });
  return key == kKeys.end() ? field : key->second;
}

/// Converts a message such as "above 0 and below size = 0.1 m" to the keys and units of the file.
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

/// An image of an experiment, with an error that does not repeat the path.
class Images {
 public:
  explicit Images(std::filesystem::path directory) : directory_(std::move(directory)) {}

  light::DecodedImage at(const std::string& name) {
    const std::filesystem::path file = directory_ / name;
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return {nullptr, "no such file"};
    light::DecodedImage decoded = files_.at(file);
    std::string& why = decoded.error;
    if (why.starts_with(file.string())) why = why.substr(file.string().size());
    why.erase(0, why.find_first_not_of(": "));
    return decoded;
  }

 private:
  std::filesystem::path directory_;
  ImageFiles files_;
};

class LayerCheck {
 public:
  LayerCheck(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
             Problems& problems)
      : form_(form), problems_(problems) {
    if (directory) images_.emplace(*directory);
    for (const RobotEntry& robot : form.robots) {
      for (std::int64_t i = 0; i < robot.count; ++i) ids_.insert(robot.id + i);
    }
  }

  void check(const std::string& path, const LayerEntry& entry) {
    checkProgram(path, entry);
    const LayerSpec layer = toLayer(entry, form_.common);
    checkPaint(path, layer);
    checkSpeed(path, entry);
    if (!problems_.concern(path)) checkDrive(path, layer);
    checkNames(path, layer.drive);
    if (entry.has_crowd) checkCrowdRule(form_, path + ".crowd", layer, problems_);
  }

 private:
  void checkProgram(const std::string& path, const LayerEntry& entry) {
    if (entry.program.empty() || problems_.concern("light_table")) return;
    const LightTable& table = form_.common.light_table;
    if (lightFor(table, entry.program)) return;
    std::string list;
    for (const LightBand& band : table.bands) {
      list += (list.empty() ? "" : ", ") + tomlString(band.program);
    }
    problems_.add(path + ".program", "found " + tomlString(entry.program) +
                                         ", allowed the program of a light band: " + list);
  }

  std::shared_ptr<const light::Image> image(const std::string& path, const std::string& name) {
    const light::DecodedImage decoded = images_->at(name);
    if (!decoded.image) {
      problems_.add(path, "found " + tomlString(name) + " (" + decoded.error +
                              "), allowed an image file beside the experiment file");
    }
    return decoded.image;
  }

  void checkPaint(const std::string& path, const LayerSpec& spec) {
    light::Layer layer = toLightLayer(spec);
    if (layer.kind == light::LayerKind::kImage) {
      if (!images_ || problems_.concern(path + ".file") || problems_.concern(path + ".files"))
        return;
      const std::vector<std::string>& sequence = spec.drive.images;
      for (std::size_t i = 0; i < sequence.size(); ++i) {
        static_cast<void>(image(path + ".files[" + std::to_string(i) + "]", sequence[i]));
      }
      if (problems_.concern(path + ".files")) return;
      layer.pixels = image(path + ".file", spec.image);
      if (!layer.pixels) return;
      layer.image = layer.pixels->sha256;
    }
    report(
        path, light::validate(layer),
        [&](const std::string& field) { return keyOf(field, layer.kind); }, layer.kind);
  }

  void checkSpeed(const std::string& path, const LayerEntry& entry) {
    const LayerSpec& layer = entry.layer;
    if (static_cast<light::LayerKind>(layer.kind) != light::LayerKind::kWave) return;
    if (problems_.concern(path + ".period_cm") || problems_.concern(path + ".speed_cm_s")) return;
    const double most = light::kLargestRate * layer.size / (2 * std::numbers::pi);
    if (std::abs(entry.speed) <= most) return;
    const FileUnit& unit = unitOf("_cm_s");
    const std::string limit = fileText(std::floor(most * 1e3) / 1e3, unit);
    problems_.add(path + ".speed_cm_s", "found " + fileText(entry.speed, unit) + ", allowed -" +
                                            limit + " to " + limit +
                                            " (for waves of this period_cm)");
  }

  void checkDrive(const std::string& path, const LayerSpec& layer) {
    const auto kind = static_cast<light::LayerKind>(layer.kind);
    if (layer.drive.follow == light::Follow::kTrail && kind != light::LayerKind::kDisk) {
      problems_.add(path + ".follow",
                    "found \"trail\", allowed only with kind = \"disk\" (its radius_cm is how far "
                    "from its axis a robot lays it down)");
      return;
    }
    report(path, light::validate(layer.drive, kind), keyOfDrive, kind);
  }

  void checkNames(const std::string& path, const light::Drive& drive) {
    if (drive.gate == light::Gate::kProgram && !problems_.concern(path + ".gate_program")) {
      checkProgramName(form_, path + ".gate_program", drive.gate_program, problems_);
    }
    if (problems_.concern("robots")) return;
    for (std::size_t i = 0; i < drive.robots.size(); ++i) {
      checkRobot(path + ".robots[" + std::to_string(i) + "]", drive.robots[i]);
    }
    if (drive.gate_robot != 0) checkRobot(path + ".gate_robot", drive.gate_robot);
  }

  void checkRobot(const std::string& path, std::int32_t id) {
    if (ids_.contains(id) || problems_.concern(path)) return;
    problems_.add(path,
                  "found " + std::to_string(id) + ", allowed the id of one of the [[robots]]");
  }

  template <typename ToKey>
  void report(const std::string& path, const std::optional<std::string>& problem,
              const ToKey& to_key, light::LayerKind kind) {
    if (!problem) return;
    const std::size_t equals = problem->find(" = ");
    const std::string key = to_key(problem->substr(0, equals));
    const std::string what = equals == std::string::npos ? *problem : problem->substr(equals + 3);
    problems_.add(path + "." + key, "found " + inCentimetres(what, kind));
  }

  const ExperimentForm& form_;
  Problems& problems_;
  std::optional<Images> images_;
  std::set<std::int64_t> ids_;
};

}  // namespace

void checkLayers(const ExperimentForm& form, const std::optional<std::filesystem::path>& directory,
                 Problems& problems) {
  LayerCheck check(form, directory, problems);
  for (std::size_t i = 0; i < form.light_steps.size(); ++i) {
    const std::vector<LayerEntry>& layers = form.light_steps[i].layers;
    for (std::size_t j = 0; j < layers.size(); ++j) {
      check.check("light.steps[" + std::to_string(i) + "].layers[" + std::to_string(j) + "]",
                  layers[j]);
    }
  }
}

}  // namespace lab::keys
