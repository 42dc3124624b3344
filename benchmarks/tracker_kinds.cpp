// tracker_kinds [--only TEXT] [--seeds N] [--first SEED] [--missed] [--out DIR]
// Paints pictures of many kinds, runs the detector over them, and prints how it does, a line a
// kind. With --missed, what was missed or wrong is said one by one, and what was refused nearby.
// With --out, the pictures are left there as DIR/<kind>_<seed>.pgm.
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tracker_cases_score.hpp"
#include "tracker_kinds_scenes.hpp"
#include "tracker_svc/detector.hpp"

namespace {

namespace fs = std::filesystem;
using lab::cases::Kind;
using lab::cases::Scene;
using lab::tracker::Detection;
using lab::tracker::Detector;
using lab::tracker::Rejection;

constexpr double kNearby = 0.7;  // [cap radii] from a robot's axis

struct Options {
  std::string only;
  std::uint64_t first = 1;
  std::uint64_t seeds = 10;
  bool missed = false;
  std::optional<fs::path> out;
};

void sayRefused(const std::vector<Rejection>& rejected, lab::optics::Pixel where, double reach) {
  for (const Rejection& one : rejected) {
    if (std::hypot(one.where.x - where.x, one.where.y - where.y) > reach) continue;
    const auto reason = lab::tracker::toText(one.reason);
    std::printf("      (%.1f, %.1f) %.*s: %.4g, allowed %.4g\n", one.where.x, one.where.y,
                static_cast<int>(reason.size()), reason.data(), static_cast<double>(one.value),
                static_cast<double>(one.limit));
  }
}

void sayUnmatched(const Kind& kind, std::uint64_t seed, const Scene& scene,
                  const lab::cases::Unmatched& left, const std::vector<Detection>& poses,
                  const std::vector<Rejection>& rejected, const Detector& detector) {
  for (const std::size_t i : left.missed) {
    const lab::cases::TrueRobot& robot = scene.truth[i];
    const double height = detector.cap().height;
    const auto at = detector.camera().project(robot.x, robot.y, height);
    const auto scale = detector.camera().scaleAt({robot.x, robot.y}, height);
    std::printf("  missed %s %llu: robot %zu at (%.4f, %.4f) %.3f, pixel (%.1f, %.1f): %s\n",
                kind.name, static_cast<unsigned long long>(seed), i, robot.x, robot.y, robot.theta,
                at.x, at.y, lab::cases::lightOn(scene, i).c_str());
    sayRefused(rejected, at,
               kNearby * detector.cap().cap_radius * std::hypot(scale.ux, scale.uy));
  }
  for (const std::size_t i : left.wrong) {
    std::printf("  wrong %s %llu: (%.4f, %.4f) %.3f, pixel (%.1f, %.1f), quality %.2f\n", kind.name,
                static_cast<unsigned long long>(seed), poses[i].x, poses[i].y, poses[i].theta,
                poses[i].middle.x, poses[i].middle.y, static_cast<double>(poses[i].quality));
  }
}

void runKind(const Kind& kind, const Options& options) {
  lab::cases::Score score;
  for (std::uint64_t seed = options.first; seed < options.first + options.seeds; ++seed) {
    const Scene scene = lab::cases::sceneOf(kind, seed);
    const lab::optics::GreyImage image = lab::cases::paint(scene);
    if (options.out) {
      std::ofstream file(*options.out / (std::string(kind.name) + '_' + std::to_string(seed) +
                                         ".pgm"), std::ios::binary);
      file << "P5\n" << image.width << ' ' << image.height << "\n255\n";
      file.write(reinterpret_cast<const char*>(image.pixels.data()),
                 static_cast<std::streamsize>(image.pixels.size()));
    }
    Detector detector(lab::optics::CameraModel(scene.settings.camera), scene.settings.cap,
                      scene.settings.imaging);
    std::vector<Rejection> rejected;
    const auto start = std::chrono::steady_clock::now();
    const std::vector<Detection> poses =
        detector.search(image.view(), options.missed ? &rejected : nullptr);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    const lab::cases::Unmatched left = score.add(scene.truth, poses, detector.camera(),
                                                 scene.settings.cap.height, took.count());
    if (options.missed) sayUnmatched(kind, seed, scene, left, poses, rejected, detector);
  }
  std::printf("%-22s %s%s\n", kind.name, score.text().c_str(),
              score.isSurprising() ? "  surprise off" : "");
  std::fflush(stdout);
}

std::optional<Options> read(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name == "--missed") {
      options.missed = true;
      continue;
    }
    if (i + 1 >= argc) return std::nullopt;
    const char* value = argv[++i];
    if (name == "--only") {
      options.only = value;
    } else if (name == "--seeds") {
      options.seeds = std::strtoull(value, nullptr, 10);
    } else if (name == "--first") {
      options.first = std::strtoull(value, nullptr, 10);
    } else if (name == "--out") {
      options.out = value;
    } else {
      return std::nullopt;
    }
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const std::optional<Options> options = read(argc, argv);
  if (!options) {
    std::fprintf(stderr,
                 "usage: tracker_kinds [--only TEXT] [--seeds N] [--first SEED] [--missed] "
                 "[--out DIR]\n");
    return 2;
  }
  if (options->out) fs::create_directories(*options->out);
  std::printf("%-22s %s\n", "kind", lab::cases::Score::header().c_str());
  for (const Kind& kind : lab::cases::kinds()) {
    if (std::string_view(kind.name).find(options->only) == std::string_view::npos) continue;
    runKind(kind, *options);
  }
  return 0;
}
