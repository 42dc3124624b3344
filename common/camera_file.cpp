#include "common/camera_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/experiment_file.hpp"
#include "common/units.hpp"
#include "light/image.hpp"

namespace lab {
namespace {

using nlohmann::json;

constexpr const char* kForm = "active-lab camera 1";
constexpr double kMostPixels = 20'000;
constexpr double kRotationSlack = 1e-3;  // of R R^T: what three written digits leave

/// An object of the file and the path that leads to it, for messages.
class Section {
 public:
  Section(std::string file, std::string path, const json& value)
      : file_(std::move(file)), path_(std::move(path)), value_(value) {
    if (!value_.is_object()) {
      fail("", fmt::format("found {}, expected {{ keys and values }}", value_.type_name()));
    }
  }

  [[nodiscard]] bool has(const char* key) const { return value_.contains(key); }

  [[nodiscard]] Section section(const char* key) const {
    return {file_, path_ + key + ".", at(key)};
  }

  [[nodiscard]] std::string text(const char* key) const {
    const json& value = at(key);
    if (!value.is_string()) fail(key, "found " + value.dump() + ", expected a text");
    return value.get<std::string>();
  }

  /// A number within limits, times `unit`.
  [[nodiscard]] double number(const char* key, double low, double high, double unit = 1) const {
    const json& value = at(key);
    if (!value.is_number()) fail(key, "found " + shortened(value) + ", expected a number");
    const double found = value.get<double>();
    if (!(found >= low && found <= high)) {
      fail(key, fmt::format("found {:g}, allowed {:g} to {:g}", found, low, high));
    }
    return found * unit;
  }

  /// number(), or `otherwise` when the key is not there.
  [[nodiscard]] double number(const char* key, double low, double high, double unit,
                              double otherwise) const {
    return has(key) ? number(key, low, high, unit) : otherwise;
  }

  [[nodiscard]] int pixels(const char* key) const {
    const double found = number(key, 1, kMostPixels);
    if (found != std::floor(found)) fail(key, fmt::format("found {:g}, expected pixels", found));
    return static_cast<int>(found);
  }

  /// All numbers of an array, nested or not, row by row.
  [[nodiscard]] std::vector<double> numbers(const char* key) const {
    std::vector<double> found;
    collect(at(key), key, found);
    return found;
  }

  /// numbers(), exactly N of them.
  template <std::size_t N>
  [[nodiscard]] std::array<double, N> numbers(const char* key) const {
    const std::vector<double> found = numbers(key);
    if (found.size() != N) {
      fail(key, fmt::format("found {} numbers, expected {}", found.size(), N));
    }
    std::array<double, N> values{};
    std::copy(found.begin(), found.end(), values.begin());
    return values;
  }

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    const std::string path =
        key.empty() && !path_.empty() ? path_.substr(0, path_.size() - 1) : path_ + key;
    throw ExperimentError({file_ + ": " + (path.empty() ? "" : path + ": ") + what});
  }

 private:
  static std::string shortened(const json& value) {
    const std::string text = value.dump();
    return text.size() <= 40 ? text : text.substr(0, 37) + "...";
  }

  [[nodiscard]] const json& at(const char* key) const {
    if (!has(key)) fail(key, "is missing (docs/cameras.md lists the keys)");
    return value_.at(key);
  }

  void collect(const json& value, const char* key, std::vector<double>& found) const {
    if (value.is_number()) {
      found.push_back(value.get<double>());
    } else if (value.is_array()) {
      for (const json& element : value) collect(element, key, found);
    } else {
      fail(key, "found " + shortened(value) + " in it, expected numbers only");
    }
  }

  std::string file_;
  std::string path_;
  const json& value_;
};

std::string readAll(const std::string& name) {
  std::ifstream stream(name, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream && !stream.eof()) {
    throw ExperimentError({name + ": cannot be read: " + std::strerror(errno)});
  }
  return text;
}

json parse(const std::string& name, const std::string& text) {
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    throw ExperimentError({fmt::format(
        "{}:{}: is no valid JSON, expected a camera calibration (lab calibrate camera writes one)",
        name, 1 + std::count(text.begin(), end, '\n'))});
  }
}

/// A rotation has orthonormal rows and keeps right hands right.
void checkRotation(const Section& file, const char* key, const std::array<double, 9>& r) {
  double worst = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      double product = i == j ? -1 : 0;
      for (std::size_t k = 0; k < 3; ++k) product += r[3 * i + k] * r[3 * j + k];
      worst = std::max(worst, std::abs(product));
    }
  }
  const double turns = r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
                       r[2] * (r[3] * r[7] - r[4] * r[6]);
  if (!(worst <= kRotationSlack)) {
    file.fail(key, fmt::format("is no rotation: R R^T differs from 1 by {:.2g}, allowed {:g}",
                               worst, kRotationSlack));
  }
  if (turns < 0) file.fail(key, "is a mirror image, expected a rotation (z of the arena is up)");
}

/// The camera must be above the caps, and not so far up that the unit is wrong.
void checkHeight(const Section& file, const char* key, const CameraCalibration& calibration) {
  const double height = optics::CameraModel(calibration.camera).centre()[2];
  const double low = calibration.cap.height + 0.05;
  constexpr double kHigh = 10;
  if (!(height >= low && height <= kHigh)) {
    file.fail(key, fmt::format("puts the camera {:.4g} cm above the floor, allowed {:g} to {:g} cm "
                               "(is its unit right, and is z of the arena up?)",
                               height * 100, low * 100, kHigh * 100));
  }
}

void checkCap(const Section& file, const char* big_key, const char* small_key,
              const optics::CapGeometry& cap) {
  if (cap.spacing() < cap.big_radius + cap.small_radius) {
    file.fail(big_key, "the circles overlap: move them apart");
  }
  if (cap.small_radius >= cap.big_radius) {
    file.fail(small_key, "the small circle must be smaller than the big one");
  }
}

optics::CapGeometry readCap(const Section& file, const std::string& unit_name, double unit,
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
  checkCap(file, ("big_offset" + unit_name).c_str(), ("small_radius" + unit_name).c_str(), cap);
  return cap;
}

optics::Imaging readImaging(const Section& file, const char* shot_key, const char* black_key) {
  const optics::Imaging usual;
  optics::Imaging imaging;
  imaging.blur = file.number("blur_px", 0, 20, 1, usual.blur);
  imaging.read_noise = file.number("read_noise_dn", 0, 100, 1, usual.read_noise);
  imaging.shot_gain = file.number(shot_key, 0, 10, 1, usual.shot_gain);
  imaging.black = file.number(black_key, 0, 100, 1, usual.black);
  return imaging;
}

CameraCalibration readOwnForm(const Section& file) {
  CameraCalibration calibration;
  optics::CameraParameters& camera = calibration.camera;
  camera.width = file.pixels("width_px");
  camera.height = file.pixels("height_px");
  camera.fx = file.number("fx_px", 1, 1e6);
  camera.fy = file.number("fy_px", 1, 1e6);
  camera.cx = file.number("cx_px", -1e6, 1e6);
  camera.cy = file.number("cy_px", -1e6, 1e6);
  camera.k1 = file.number("k1", -100, 100);
  camera.k2 = file.number("k2", -100, 100);
  camera.p1 = file.number("p1", -100, 100);
  camera.p2 = file.number("p2", -100, 100);
  camera.k3 = file.number("k3", -100, 100);
  camera.rotation = file.numbers<9>("rotation");
  checkRotation(file, "rotation", camera.rotation);
  camera.translation = file.numbers<3>("translation_m");
  calibration.cap = readCap(file.section("cap"), "_m", 1, "height");
  if (file.has("imaging")) {
    calibration.imaging = readImaging(file.section("imaging"), "shot_gain_dn", "black_dn");
  }
  const Section arena = file.section("arena");
  calibration.arena_width = arena.number("width_m", 0.01, 100);
  calibration.arena_height = arena.number("height_m", 0.01, 100);
  if (file.has("residual_m")) calibration.residual = file.number("residual_m", 0, 1);
  checkHeight(file, "translation_m", calibration);
  return calibration;
}

void readDistortion(const Section& file, optics::CameraParameters& camera) {
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
  camera.k1 = dist[0];
  camera.k2 = dist[1];
  camera.p1 = dist[2];
  camera.p2 = dist[3];
  camera.k3 = dist[4];
}

CameraCalibration readOpenCvForm(const Section& file) {
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
    const Section geometry = file.section("geometry");
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
  return calibration;
}

}  // namespace

CameraCalibration readCameraFile(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string text = readAll(name);
  const json root = parse(name, text);
  const Section file(name, "", root);
  if (!file.has("form") && !file.has("K")) {
    file.fail("",
              fmt::format("is no camera calibration: found neither \"form\": \"{}\" nor K, dist,"
                          " R, t (docs/cameras.md)",
                          kForm));
  }
  if (file.has("form") && file.text("form") != kForm) {
    file.fail("form", fmt::format("found \"{}\", expected \"{}\"", file.text("form"), kForm));
  }
  CameraCalibration calibration = file.has("form") ? readOwnForm(file) : readOpenCvForm(file);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
  calibration.id = light::sha256({bytes, text.size()}).substr(0, 12);
  return calibration;
}

std::string cameraFileText(const CameraCalibration& calibration) {
  const optics::CameraParameters& camera = calibration.camera;
  const optics::CapGeometry& cap = calibration.cap;
  nlohmann::ordered_json file = {
      {"form", kForm},
      {"width_px", camera.width},
      {"height_px", camera.height},
      {"fx_px", camera.fx},
      {"fy_px", camera.fy},
      {"cx_px", camera.cx},
      {"cy_px", camera.cy},
      {"k1", camera.k1},
      {"k2", camera.k2},
      {"p1", camera.p1},
      {"p2", camera.p2},
      {"k3", camera.k3},
      {"rotation", camera.rotation},
      {"translation_m", camera.translation},
      {"cap",
       {{"robot_radius_m", cap.robot_radius},
        {"cap_radius_m", cap.cap_radius},
        {"height_m", cap.height},
        {"big_radius_m", cap.big_radius},
        {"small_radius_m", cap.small_radius},
        {"big_offset_m", cap.big_offset},
        {"small_offset_m", cap.small_offset}}},
      {"arena", {{"width_m", calibration.arena_width}, {"height_m", calibration.arena_height}}}};
  if (calibration.imaging) {
    file["imaging"] = {{"blur_px", calibration.imaging->blur},
                       {"read_noise_dn", calibration.imaging->read_noise},
                       {"shot_gain_dn", calibration.imaging->shot_gain},
                       {"black_dn", calibration.imaging->black}};
  }
  if (calibration.residual) file["residual_m"] = *calibration.residual;
  return file.dump(2) + "\n";
}

}  // namespace lab
