#include "runner/film/film_markers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/math/units.hpp"
#include "light/optics/tag_pattern.hpp"

namespace lab::runner {
namespace {

/// Refuses options of another kind of markers.
void refuseForeign(const TrackOptions& options) {
  const bool blobs = options.marker == "blobs";
  const bool tags = options.marker == "tags";
  const auto refuse = [&](bool given, const char* option, const char* kind) {
    if (!given) return;
    throw UserError(
        fmt::format("{}: found with --marker {}, expected with --marker {}: leave it out", option,
                    options.marker, kind));
  };
  if (!blobs) {
    refuse(!options.blob_tone.empty(), "--blob", "blobs");
    refuse(!options.diameters_cm.empty(), "--diameter-cm", "blobs");
    refuse(options.max_speed_cm_s > 0, "--max-speed-cm-s", "blobs");
  }
  if (!tags) {
    refuse(!options.tag_family.empty(), "--tag-family", "tags");
    refuse(options.tag_size_cm > 0, "--tag-size-cm", "tags");
  }
  if (!blobs && !tags) {
    refuse(options.cm_per_px > 0, "--cm-per-px", "blobs or tags");
    refuse(options.height_cm.has_value(), "--height-cm", "blobs or tags");
  }
}

}  // namespace

detector::MarkerSettings markersOf(const TrackOptions& options,
                                   const CameraCalibration& calibration) {
  refuseForeign(options);
  detector::MarkerSettings markers;
  if (options.marker == "blobs") {
    markers.kind = detector::MarkerKind::kBlobs;
    const std::vector<double>& diameters = options.diameters_cm;
    if (diameters.size() != 2 || !(diameters[0] > 0) || !(diameters[1] > diameters[0])) {
      throw UserError(fmt::format(
          "--diameter-cm: found {}, expected the smallest and the largest diameter of one blob, "
          "for example --diameter-cm 0.5 1.2",
          diameters.empty() ? std::string("nothing")
                            : fmt::format("{:g}", fmt::join(diameters, " "))));
    }
    markers.blobs = {.bright = options.blob_tone == "bright",
                     .smallest = diameters[0] / units::kCm,
                     .largest = diameters[1] / units::kCm,
                     .height = options.height_cm.value_or(0) / units::kCm,
                     .arena_width = calibration.arena_width,
                     .arena_height = calibration.arena_height};
  } else if (options.marker == "tags") {
    markers.kind = detector::MarkerKind::kTags;
    const std::vector<std::string> families = optics::tagFamilies();
    const std::string family = options.tag_family.empty() ? families.front() : options.tag_family;
    if (std::find(families.begin(), families.end(), family) == families.end()) {
      throw UserError(fmt::format("--tag-family: found \"{}\", expected one of {}", family,
                                  fmt::join(families, ", ")));
    }
    if (!(options.tag_size_cm > 0)) {
      throw UserError(
          "--tag-size-cm: found nothing, expected the side of a tag where its black border meets "
          "white, for example --tag-size-cm 4");
    }
    markers.tags = {
        .family = family,
        .size = options.tag_size_cm / units::kCm,
        .height = options.height_cm.value_or(calibration.cap.height * units::kCm) / units::kCm};
  }
  return markers;
}

CameraCalibration cameraAbove(int width, int height, double cm_per_px) {
  constexpr double kFar = 1e4;  // [pictures] so far away that there is no parallax
  const double pixel = cm_per_px / units::kCm;
  const double distance = kFar * pixel * std::max(width, height);
  CameraCalibration calibration;
  calibration.arena_width = pixel * width;
  calibration.arena_height = pixel * height;
  optics::CameraParameters& camera = calibration.camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = distance / pixel;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  camera.rotation = {1, 0, 0, 0, -1, 0, 0, 0, -1};
  camera.translation = {-calibration.arena_width / 2, calibration.arena_height / 2, distance};
  calibration.cap.height = 0;
  calibration.id = "scale";
  return calibration;
}

}  // namespace lab::runner
