// tracker_kinds [--only TEXT] [--seeds N] [--first SEED] [--missed] [--out DIR] [--results FILE]
// Paints pictures of many kinds, runs the detector on them, and prints one line per kind. Fails if
// a kind does not meet its limits. With --missed, lists every missed robot and wrong pose with the
// rejected candidates nearby. With --out, writes the pictures to DIR/<kind>_<seed>.pgm; with
// --results, writes the lines to FILE.
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

#include "tests/support/tracker_scenes/acceptance_limits.hpp"
#include "tests/support/tracker_scenes/scenes.hpp"
#include "tests/support/tracker_scenes/score.hpp"
#include "tracker_svc/detector.hpp"

namespace {

namespace fs = std::filesystem;
using lab::cases::DetectedScene;
using lab::cases::SceneKind;
using lab::detector::Detection;
using lab::detector::Rejection;

constexpr double kNearby = 0.7;  // [cap radii] from a robot's axis

struct Options {
  std::string only;
  std::uint64_t first = 1;
  std::uint64_t seeds = 10;
  bool missed = false;
  std::optional<fs::path> out;
  fs::path results;
};

void sayRefused(const std::vector<Rejection>& rejected, lab::optics::Pixel where, double reach) {
  for (const Rejection& one : rejected) {
    if (std::hypot(one.where.x - where.x, one.where.y - where.y) > reach) continue;
    const auto reason = lab::detector::toText(one.reason);
    std::printf("      (%.1f, %.1f) %.*s: %.4g, allowed %.4g\n", one.where.x, one.where.y,
                static_cast<int>(reason.size()), reason.data(), static_cast<double>(one.value),
                static_cast<double>(one.limit));
  }
}

void sayUnmatched(const SceneKind& kind, std::uint64_t seed, const DetectedScene& look) {
  const lab::optics::CameraModel camera(look.scene.settings.camera);
  const lab::optics::CapGeometry& cap = look.scene.settings.cap;
  for (const std::size_t i : look.left.missed) {
    const lab::cases::TrueRobot& robot = look.scene.truth[i];
    const auto at = camera.project(robot.x, robot.y, cap.height);
    const auto scale = camera.scaleAt({robot.x, robot.y}, cap.height);
    std::printf("  missed %s %llu: robot %zu at (%.4f, %.4f) %.3f, pixel (%.1f, %.1f): %s\n",
                kind.name, static_cast<unsigned long long>(seed), i, robot.x, robot.y, robot.theta,
                at.x, at.y, lab::cases::lightOn(look.scene, i).c_str());
    sayRefused(look.rejected, at, kNearby * cap.cap_radius * std::hypot(scale.ux, scale.uy));
  }
  for (const std::size_t i : look.left.wrong) {
    const Detection& pose = look.poses[i];
    std::printf("  wrong %s %llu: (%.4f, %.4f) %.3f, pixel (%.1f, %.1f), quality %.2f\n", kind.name,
                static_cast<unsigned long long>(seed), pose.x, pose.y, pose.theta, pose.middle.x,
                pose.middle.y, static_cast<double>(pose.quality));
  }
}

void leave(const lab::optics::GreyImage& image, const fs::path& file) {
  std::ofstream out(file, std::ios::binary);
  out << "P5\n" << image.width << ' ' << image.height << "\n255\n";
  out.write(reinterpret_cast<const char*>(image.pixels.data()),
            static_cast<std::streamsize>(image.pixels.size()));
}

/// @return whether all limits were met, except known shortfalls
bool runKind(const SceneKind& kind, const Options& options, std::ofstream& results) {
  lab::cases::Score score;
  for (std::uint64_t seed = options.first; seed < options.first + options.seeds; ++seed) {
    const DetectedScene look = lab::cases::look(kind, seed, options.missed, score);
    if (options.out) {
      leave(look.image,
            *options.out / (std::string(kind.name) + '_' + std::to_string(seed) + ".pgm"));
    }
    if (options.missed) sayUnmatched(kind, seed, look);
  }
  std::string text(kind.name);
  text.resize(23, ' ');
  text += score.text() + (score.isInconsistent() ? "  NEES off" : "") + '\n';
  bool all = true;
  for (const lab::cases::Shortfall& one : lab::cases::shortOf(kind.limits, score.tally())) {
    text += (one.known ? "  known: " : "  LIMIT NOT MET: ") + one.what + '\n';
    all = all && one.known;
  }
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
  results << text << std::flush;
  return all;
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
      if (options.seeds == 0) return std::nullopt;
    } else if (name == "--first") {
      options.first = std::strtoull(value, nullptr, 10);
    } else if (name == "--out") {
      options.out = value;
    } else if (name == "--results") {
      options.results = value;
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
                 "[--out DIR] [--results FILE]\n");
    return 2;
  }
  if (options->out) fs::create_directories(*options->out);
  std::ofstream results(options->results);
  std::printf("%-22s %s\n", "kind", lab::cases::Score::header().c_str());
  bool any = false;
  bool all = true;
  for (const SceneKind& kind : lab::cases::kinds()) {
    if (std::string_view(kind.name).find(options->only) == std::string_view::npos) continue;
    any = true;
    all = runKind(kind, *options, results) && all;
  }
  if (!any) std::fprintf(stderr, "tracker_kinds: no kind contains %s\n", options->only.c_str());
  return any && all ? 0 : 1;
}
