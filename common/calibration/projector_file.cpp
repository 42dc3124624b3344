#include "common/calibration/projector_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "common/calibration/lens_json.hpp"
#include "common/files/file_text.hpp"
#include "common/files/json_section.hpp"
#include "common/math/units.hpp"

namespace lab {
namespace {

constexpr const char* kProjectorForm = "active-lab projector 1";
constexpr double kSameSide = 1e-4;   // [m] of an arena's side
constexpr double kSamePlace = 1e-6;  // [m] of a place mapped to its pixel and back

std::optional<double> optionalNumber(const JsonSection& file, const char* key, double high) {
  if (!file.has(key)) return std::nullopt;
  return file.number(key, 0, high);
}

/// Checks that every place of the arena is mapped to a pixel and back to itself; otherwise the
/// numbers describe no lens.
void checkLens(const JsonSection& file, const ProjectorCalibration& calibration) {
  constexpr int kSteps = 8;
  const optics::ProjectorModel model = calibration.model();
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i <= kSteps; ++i) {
      const optics::Place place{calibration.arena_width * i / kSteps,
                                calibration.arena_height * j / kSteps};
      const auto back = model.placeOf(model.pixelOf(place));
      if (back && std::hypot(back->x - place.x, back->y - place.y) < kSamePlace) continue;
      file.fail("",
                fmt::format("is of no lens: the place ({:.1f}, {:.1f}) cm of the arena does not "
                            "come back from its pixel; calibrate again",
                            place.x / units::kCentimetre, place.y / units::kCentimetre));
    }
  }
}

}  // namespace

ProjectorCalibration readProjectorFile(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string text = readFileText(path, file_kinds::kCalibration);
  const nlohmann::json root =
      parseJson(name, text, "a projector calibration (lab calibrate projector writes one)");
  const JsonSection file(name, "docs/calibration.md lists the keys", root);
  if (!file.has("form")) {
    file.fail("",
              fmt::format("is no projector calibration: found no \"form\": \"{}\"; lab calibrate "
                          "projector writes one",
                          kProjectorForm));
  }
  if (file.text("form") != kProjectorForm) {
    file.fail("form",
              fmt::format("found \"{}\", expected \"{}\"", file.text("form"), kProjectorForm));
  }
  ProjectorCalibration calibration;
  calibration.lens = readLens(file, true);
  calibration.height = file.number("height_m", 0, 1);
  const JsonSection arena = file.section("arena");
  calibration.arena_width = arena.number("width_m", 0.01, 100);
  calibration.arena_height = arena.number("height_m", 0.01, 100);
  calibration.method = file.text("method");
  calibration.camera_id = file.text("camera");
  calibration.residual = optionalNumber(file, "residual_m", 1);
  calibration.accuracy = optionalNumber(file, "accuracy_m", 1);
  calibration.worst = optionalNumber(file, "worst_m", 1);
  calibration.covered = optionalNumber(file, "covered", 1);
  checkLens(file, calibration);
  calibration.id = fileId(text);
  return calibration;
}

std::string projectorFileText(const ProjectorCalibration& calibration) {
  nlohmann::ordered_json file = {{"form", kProjectorForm}};
  writeLens(file, calibration.lens);
  file["height_m"] = calibration.height;
  file["arena"] = {{"width_m", calibration.arena_width}, {"height_m", calibration.arena_height}};
  file["method"] = calibration.method;
  file["camera"] = calibration.camera_id;
  if (calibration.residual) file["residual_m"] = *calibration.residual;
  if (calibration.accuracy) file["accuracy_m"] = *calibration.accuracy;
  if (calibration.worst) file["worst_m"] = *calibration.worst;
  if (calibration.covered) file["covered"] = *calibration.covered;
  return file.dump(2) + "\n";
}

ActiveProjectorCalibration activeProjectorCalibration(const Experiment& experiment,
                                                      const std::filesystem::path& directory,
                                                      int columns, int rows) {
  const double width = experiment.arena_width;
  const double height = experiment.arena_height;
  if (experiment.projector.calibration.empty()) {
    return {optics::ProjectorModel(width, height, columns, rows), ""};
  }
  const std::filesystem::path path = directory / experiment.projector.calibration;
  const ProjectorCalibration found = readProjectorFile(path);
  if (found.lens.width != columns || found.lens.height != rows) {
    throw ExperimentError(
        {fmt::format("{}: found a calibration of {} x {} pixels, expected {} x {} as the "
                     "projector's picture has; "
                     "set the display to that resolution, or calibrate again",
                     path.string(), found.lens.width, found.lens.height, columns, rows)});
  }
  if (std::abs(found.arena_width - width) > kSameSide ||
      std::abs(found.arena_height - height) > kSameSide) {
    throw ExperimentError(
        {fmt::format("{}: found a calibration of an arena of {:.2f} x {:.2f} cm, expected {:.2f} x "
                     "{:.2f} cm as in "
                     "the experiment; calibrate again",
                     path.string(), found.arena_width / units::kCentimetre,
                     found.arena_height / units::kCentimetre, width / units::kCentimetre,
                     height / units::kCentimetre)});
  }
  return {found.model(), found.id};
}

void checkProjectorFile(const Experiment& experiment, const std::filesystem::path& directory) {
  const Projector& projector = experiment.projector;
  if (projector.calibration.empty()) return;
  int columns = projector.width;
  int rows = projector.height;
  if (projector.display != kHeadless) {
    const optics::CameraParameters lens = readProjectorFile(directory / projector.calibration).lens;
    columns = lens.width;
    rows = lens.height;
  }
  static_cast<void>(activeProjectorCalibration(experiment, directory, columns, rows));
}

}  // namespace lab
