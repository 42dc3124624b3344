// tracker_cases CASES_DIR [--out DIR] [--only TEXT] [--encode GAMMA]
// Runs the detector, and two simple OpenCV trackers if OpenCV is installed, on every folder of
// pictures with ground truth, and prints the results. --out writes the detector's poses to
// <case>.csv; --encode encodes the pictures with that gamma, which the detector does not know.
#include <stb/stb_image.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/calibration/camera_file.hpp"
#include "light/photometry/camera_response.hpp"
#include "tests/support/tracker_scenes/score.hpp"
#ifdef LAB_HAS_OPENCV
#include "tests/benchmarks/tracker_cases_opencv.hpp"
#endif
#include "tracker_svc/detector.hpp"
#include "tracker_svc/response_finder.hpp"

namespace {

namespace fs = std::filesystem;
using lab::detector::Detection;
using lab::optics::GreyImage;
using lab::optics::GreyView;

constexpr int kRounds = 5;  // the fastest is used

using Finder = std::function<std::vector<Detection>(const GreyView&)>;
struct Method {
  std::string name;
  Finder find;
  lab::cases::Score score;
};

std::optional<GreyImage> readPicture(const fs::path& file) {
  int width = 0;
  int height = 0;
  int channels = 0;
  unsigned char* pixels = stbi_load(file.c_str(), &width, &height, &channels, 0);
  if (pixels == nullptr) return std::nullopt;
  GreyImage image(width, height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const unsigned char* at = pixels + i * static_cast<std::size_t>(channels);
    image.pixels[i] =
        channels < 3 ? at[0] : static_cast<std::uint8_t>((at[0] + 2 * at[1] + at[2]) / 4);
  }
  stbi_image_free(pixels);
  return image;
}

std::vector<Method> methodsFor(const lab::CameraCalibration& calibration,
                               lab::detector::Detector& detector) {
  std::vector<Method> methods;
  methods.push_back(
      {"ours", [&](const GreyView& picture) { return detector.search(picture); }, {}});
#ifdef LAB_HAS_OPENCV
  using lab::cases::Plain;
  for (const Plain kind : {Plain::kAdaptive, Plain::kBlobs}) {
    methods.push_back({kind == Plain::kAdaptive ? "contours" : "blobs",
                       [&, kind](const GreyView& picture) {
                         return lab::cases::findPlainly(kind, picture, detector.camera(),
                                                        calibration.cap);
                       },
                       {}});
  }
#else
  static_cast<void>(calibration);
#endif
  return methods;
}

void encode(GreyImage& image, double gamma, double black) {
  const lab::optics::CameraResponse camera(gamma, black);
  std::array<std::uint8_t, 256> steps;
  for (std::size_t light = 0; light < steps.size(); ++light) {
    steps[light] = static_cast<std::uint8_t>(std::lround(camera.grey(static_cast<double>(light))));
  }
  for (std::uint8_t& pixel : image.pixels) pixel = steps[pixel];
}

void runCase(const fs::path& folder, const std::optional<fs::path>& out,
             std::optional<double> gamma) {
  const lab::CameraCalibration calibration = lab::readCameraFile(folder / "calib.json");
  const lab::optics::Imaging imaging = calibration.imaging.value_or(lab::optics::Imaging{});
  lab::detector::Detector detector(lab::optics::CameraModel(calibration.camera), calibration.cap,
                                   imaging);
  lab::detector::ResponseFinder response(detector.camera(), calibration.cap, imaging);
  auto truth = lab::cases::readTruth(folder / "truth.csv");
  std::vector<Method> methods = methodsFor(calibration, detector);
  std::ofstream csv;
  if (out) {
    csv.open(*out / (folder.filename().string() + ".csv"));
    csv.precision(9);
    csv << "frame,id,x_cm,y_cm,theta_rad,u,v\n";
  }
  for (int frame = 0;; ++frame) {
    char name[16];
    std::snprintf(name, sizeof name, "f%04d.png", frame);
    std::optional<GreyImage> read = readPicture(folder / name);
    if (!read) break;
    if (gamma) {
      encode(*read, *gamma, imaging.black);
      response.examine(read->view());
      detector.setGamma(response.gamma().value_or(1));
    }
    const GreyView picture{read->pixels.data(), read->width, read->height, read->width};
    for (Method& method : methods) {
      double fastest = 1e9;
      std::vector<Detection> poses;
      for (int round = 0; round < kRounds; ++round) {
        const auto start = std::chrono::steady_clock::now();
        poses = method.find(picture);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        fastest = std::min(fastest, took.count());
      }
      method.score.add(truth[frame], poses, detector.camera(), calibration.cap.height, fastest);
      if (&method != &methods.front()) continue;
      for (std::size_t i = 0; csv.is_open() && i < poses.size(); ++i) {
        csv << frame << ',' << i << ',' << poses[i].x * 100 << ',' << poses[i].y * 100 << ','
            << poses[i].theta << ',' << poses[i].middle.x << ',' << poses[i].middle.y << '\n';
      }
    }
  }
  for (const Method& method : methods) {
    std::printf("%-22s %-9s %s\n", folder.filename().c_str(), method.name.c_str(),
                method.score.text().c_str());
  }
}

int run(int argc, char** argv) {
  std::optional<fs::path> out;
  std::string only;
  std::optional<double> gamma;
  for (int i = 2; i + 1 < argc; i += 2) {
    if (std::string(argv[i]) == "--out") out = argv[i + 1];
    if (std::string(argv[i]) == "--only") only = argv[i + 1];
    if (std::string(argv[i]) == "--encode") gamma = std::atof(argv[i + 1]);
  }
  if (out) fs::create_directories(*out);
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(argv[1])) {
    const bool wanted = entry.path().filename().string().find(only) != std::string::npos;
    if (wanted && fs::exists(entry.path() / "calib.json")) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  std::printf("%-22s %-9s %s\n", "case", "method", lab::cases::Score::header().c_str());
  for (const fs::path& folder : folders) runCase(folder, out, gamma);
  return folders.empty() ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || !fs::is_directory(argv[1])) {
    std::fprintf(stderr,
                 "usage: tracker_cases CASES_DIR [--out DIR] [--only TEXT] [--encode GAMMA]\n");
    return 2;
  }
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tracker_cases: %s\n", error.what());
    return 1;
  }
}
