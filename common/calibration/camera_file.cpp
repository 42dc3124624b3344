#include "common/calibration/camera_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/calibration/lens_json.hpp"
#include "common/files/file_text.hpp"
#include "common/files/json_section.hpp"
#include "common/math/units.hpp"

namespace lab {
namespace {

constexpr const char* kCameraForm = "active-lab camera 1";

/// Checks the camera's height: above the caps, and not so large that the unit must be wrong.
void checkHeight(const JsonSection& file, const char* key, const CameraCalibration& calibration) {
  const double height = optics::CameraModel(calibration.camera).centre()[2];
  const double low = calibration.cap.height + 0.05;
  constexpr double kHigh = 10;
  if (!(height >= low && height <= kHigh)) {
    file.fail(key, fmt::format("puts the camera {:.4g} cm above the floor, allowed {:g} to {:g} cm "
                               "(is its unit right, and is z of the arena up?)",
                               height * 100, low * 100, kHigh * 100));
  }
}

/// Checks that the caps' circles are visible, and small enough for the search in the picture.
void checkScale(const JsonSection& file, const char* key, const CameraCalibration& calibration) {
  const optics::CameraParameters& camera = calibration.camera;
  const double away = optics::CameraModel(camera).centre()[2] - calibration.cap.height;
  constexpr double kLow = 0.5;
  const double high = std::min(camera.width, camera.height) / 4.0;
  for (const double focal : {camera.fx, camera.fy}) {
    const double radius = focal * calibration.cap.big_radius / away;
    if (radius >= kLow && radius <= high) continue;
    file.fail(key, fmt::format("of {:g} px makes the big circles {:.3g} px in radius, allowed {:g} "
                               "to {:g} px (a quarter of the picture)",
                               focal, radius, kLow, high));
  }
}

optics::CapGeometry readCap(const JsonSection& file, const std::string& unit_name, double unit,
                            const char* height_key) {
  const optics::CapGeometry usual;
  const auto length = [&](const std::string& key, double low, double high, double otherwise) {
    return file.number((key + unit_name).c_str(), low / unit, high / unit, unit, otherwise);
  };
  optics::CapGeometry cap;
  cap.robot_radius = length("robot_radius", 0.005, 1, usual.robot_radius);
  cap.cap_radius = length("cap_radius", 0.005, 1, usual.cap_radius);
  cap.height = length(height_key, 0, 1, usual.height);
  cap.big_radius = length("big_radius", 0.0005, 0.5, usual.big_radius);
  cap.small_radius = length("small_radius", 0.0005, 0.5, usual.small_radius);
  cap.big_offset = length("big_offset", -0.5, 0.5, usual.big_offset);
  cap.small_offset = length("small_offset", -0.5, 0.5, usual.small_offset);
  if (const auto fault = optics::capFault(cap)) {
    file.fail((fault->size + unit_name).c_str(), fault->what);
  }
  return cap;
}

optics::Imaging readImaging(const JsonSection& file, const char* shot_key, const char* black_key) {
  const optics::Imaging usual;
  optics::Imaging imaging;
  imaging.blur = file.number("blur_px", 0, 20, 1, usual.blur);
  imaging.read_noise = file.number("read_noise_dn", 0, 100, 1, usual.read_noise);
  imaging.shot_gain = file.number(shot_key, 0, 10, 1, usual.shot_gain);
  imaging.black = file.number(black_key, 0, 100, 1, usual.black);
  if (file.has("gamma")) imaging.gamma = file.number("gamma", 0.2, 5);
  return imaging;
}

CameraCalibration readOwnForm(const JsonSection& file) {
  CameraCalibration calibration;
  calibration.camera = readLens(file, false);
  calibration.cap = readCap(file.section("cap"), "_m", 1, "height");
  if (file.has("imaging")) {
    calibration.imaging = readImaging(file.section("imaging"), "shot_gain_dn", "black_dn");
  }
  const JsonSection arena = file.section("arena");
  calibration.arena_width = arena.number("width_m", 0.01, 100);
  calibration.arena_height = arena.number("height_m", 0.01, 100);
  if (file.has("residual_m")) calibration.residual = file.number("residual_m", 0, 1);
  checkHeight(file, "translation_m", calibration);
  checkScale(file, "fx_px", calibration);
  return calibration;
}

void readDistortion(const JsonSection& file, optics::CameraParameters& camera) {
  std::vector<double> dist = file.numbers("dist");
  if (dist.size() < 4) {
    file.fail("dist",
              fmt::format("found {} numbers, expected k1, k2, p1, p2 and perhaps k3", dist.size()));
  }
  for (std::size_t i = 5; i < dist.size(); ++i) {
    if (dist[i] != 0) {
      file.fail("dist", fmt::format("number {} is {:g}, and only k1, k2, p1, p2, k3 are known: "
                                    "calibrate without the rational, prism and tilt models",
                                    i + 1, dist[i]));
    }
  }
  dist.resize(5);
  for (const double one : dist) {
    if (!(std::abs(one) <= kMostDistortion)) {
      file.fail("dist", fmt::format("found {:g} in it, allowed {:g} to {:g}", one, -kMostDistortion,
                                    kMostDistortion));
    }
  }
  camera.k1 = dist[0];
  camera.k2 = dist[1];
  camera.p1 = dist[2];
  camera.p2 = dist[3];
  camera.k3 = dist[4];
}

CameraCalibration readOpenCvForm(const JsonSection& file) {
  using units::kCentimetre;
  CameraCalibration calibration;
  optics::CameraParameters& camera = calibration.camera;
  camera.width = file.pixels("width");
  camera.height = file.pixels("height");
  const std::array<double, 9> k = file.numbers<9>("K");
  const bool has_form = k[1] == 0 && k[3] == 0 && k[6] == 0 && k[7] == 0 && k[8] == 1;
  if (!has_form || !(k[0] >= 1 && k[4] >= 1)) {
    file.fail("K", "expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] in pixels");
  }
  camera.fx = k[0];
  camera.fy = k[4];
  camera.cx = k[2];
  camera.cy = k[5];
  readDistortion(file, camera);
  camera.rotation = file.numbers<9>("R");
  checkRotation(file, "R", camera.rotation);
  camera.translation = file.numbers<3>("t");
  for (double& length : camera.translation) length *= kCentimetre;
  if (file.has("geometry")) {
    const JsonSection geometry = file.section("geometry");
    calibration.cap = readCap(geometry, "_cm", kCentimetre, "cap_plane_z");
    calibration.arena_width =
        geometry.number("arena_w_cm", 1, 10'000, kCentimetre, calibration.arena_width);
    calibration.arena_height =
        geometry.number("arena_h_cm", 1, 10'000, kCentimetre, calibration.arena_height);
  }
  if (file.has("noise")) {
    calibration.imaging = readImaging(file.section("noise"), "shot_gain", "black_level");
  }
  checkHeight(file, "t", calibration);
  checkScale(file, "K", calibration);
  for (const double one : k) {
    if (!(std::abs(one) <= kMostLensPixels)) {
      file.fail("K",
                fmt::format("found {:g} in it, allowed are at most {:g} px", one, kMostLensPixels));
    }
  }
  return calibration;
}

}  // namespace

CameraCalibration readCameraFile(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string text = readFileText(path, file_kinds::kCalibration);
  const nlohmann::json root =
      parseJson(name, text, "a camera calibration (lab calibrate camera writes one)");
  const JsonSection file(name, "docs/cameras.md lists the keys", root);
  if (!file.has("form") && !file.has("K")) {
    file.fail("",
              fmt::format("is no camera calibration: found neither \"form\": \"{}\" nor K, dist,"
                          " R, t (docs/cameras.md)",
                          kCameraForm));
  }
  if (file.has("form") && file.text("form") != kCameraForm) {
    file.fail("form", fmt::format("found \"{}\", expected \"{}\"", file.text("form"), kCameraForm));
  }
  CameraCalibration calibration = file.has("form") ? readOwnForm(file) : readOpenCvForm(file);
  calibration.id = fileId(text);
  return calibration;
}

std::string cameraFileText(const CameraCalibration& calibration) {
  const optics::CapGeometry& cap = calibration.cap;
  nlohmann::ordered_json file = {{"form", kCameraForm}};
  writeLens(file, calibration.camera);
  file["cap"] = {{"robot_radius_m", cap.robot_radius},
                 {"cap_radius_m", cap.cap_radius},
                 {"height_m", cap.height},
                 {"big_radius_m", cap.big_radius},
                 {"small_radius_m", cap.small_radius},
                 {"big_offset_m", cap.big_offset},
                 {"small_offset_m", cap.small_offset}};
  file["arena"] = {{"width_m", calibration.arena_width}, {"height_m", calibration.arena_height}};
  if (calibration.imaging) {
    file["imaging"] = {{"blur_px", calibration.imaging->blur},
                       {"read_noise_dn", calibration.imaging->read_noise},
                       {"shot_gain_dn", calibration.imaging->shot_gain},
                       {"black_dn", calibration.imaging->black}};
    if (calibration.imaging->gamma) file["imaging"]["gamma"] = *calibration.imaging->gamma;
  }
  if (calibration.residual) file["residual_m"] = *calibration.residual;
  return file.dump(2) + "\n";
}

}  // namespace lab
