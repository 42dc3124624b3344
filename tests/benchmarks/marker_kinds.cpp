// marker_kinds [--only TEXT] [--seeds N] [--first SEED] [--results FILE] [--out DIR]
// Paints pictures of blobs and tags (tests/support/marker_scenes), runs the detectors on them,
// beside OpenCV's SimpleBlobDetector (if it is installed) and libapriltag alone, and prints one
// line per kind and detector. Fails if a kind does not meet its limits: recall of 99 %.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tests/benchmarks/marker_baselines.hpp"
#include "tests/support/marker_scenes/marker_scene.hpp"
#include "tests/support/marker_scenes/marker_score.hpp"
#include "tracker_svc/marker_detector.hpp"

namespace {

using lab::cases::MarkerKind;
using lab::cases::MarkerScore;
using lab::cases::TrueMarker;
using lab::detector::Detection;

constexpr double kRecall = 0.99;

struct Options {
  std::string only;
  std::uint64_t first = 1;
  std::uint64_t seeds = 10;
  std::filesystem::path results;
  std::filesystem::path out;
};

std::unique_ptr<lab::detector::MarkerDetector> detectorOf(const MarkerKind& kind) {
  const lab::optics::CameraModel camera = cameraOf(kind.settings);
  const lab::optics::Imaging imaging{.gamma = 1};
  if (kind.tags) {
    return lab::detector::makeTagDetector(camera, imaging,
                                          {.family = kind.settings.family,
                                           .size = 2 * kind.long_axis,
                                           .height = kind.settings.plane});
  }
  return lab::detector::makeBlobDetector(
      camera, imaging,
      {.bright = kind.bright,
       .smallest = 1.2 * kind.short_axis,
       .largest = 2.6 * kind.short_axis * std::sqrt(kind.long_axis / kind.short_axis),
       .height = kind.settings.plane,
       .arena_width = kind.settings.arena_width,
       .arena_height = kind.settings.arena_height});
}

template <class Detect>
void score(MarkerScore& total, const MarkerKind& kind, const std::vector<TrueMarker>& truth,
           const Detect& detect) {
  const std::clock_t begin = std::clock();  // of the processor
  const std::vector<Detection> poses = detect();
  const double time = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  total.add(kind, truth, poses, time);
}

void leave(const lab::optics::GreyImage& image, const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::binary);
  out << "P5\n" << image.width << ' ' << image.height << "\n255\n";
  out.write(reinterpret_cast<const char*>(image.pixels.data()),
            static_cast<std::streamsize>(image.pixels.size()));
}

bool runKind(const MarkerKind& kind, const Options& options, std::ofstream& results) {
  const auto detector = detectorOf(kind);
  MarkerScore own;
  MarkerScore baseline;
  for (std::uint64_t seed = options.first; seed < options.first + options.seeds; ++seed) {
    lab::cases::MarkerSceneSettings settings = kind.settings;
    settings.seed = seed;
    const std::vector<TrueMarker> truth = placeMarkers(kind, seed);
    const lab::optics::GreyImage picture = paintMarkers(settings, truth);
    if (!options.out.empty()) {
      leave(picture, options.out / (kind.name + "_" + std::to_string(seed) + ".pgm"));
    }
    score(own, kind, truth, [&] { return detector->search(picture.view()); });
    if (kind.tags || lab::cases::hasBlobBaseline()) {
      score(baseline, kind, truth, [&] { return lab::cases::baseline(kind, picture.view()); });
    }
  }
  const bool met = own.recall() >= kRecall;
  const auto print = [&](const char* who, const MarkerScore& one) {
    char line[300];
    std::snprintf(line, sizeof line, "%-22s %-12s %s%s\n", kind.name.c_str(), who,
                  one.text().c_str(), &one == &own && !met ? "  below the limit" : "");
    std::fputs(line, stdout);
    if (results) results << line;
  };
  print("lab", own);
  if (baseline.pictures > 0) print(kind.tags ? "libapriltag" : "OpenCV", baseline);
  return met;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Recall, precision and errors of blobs and tags");
  app.add_option("--only", options.only);
  app.add_option("--first", options.first);
  app.add_option("--seeds", options.seeds);
  app.add_option("--results", options.results);
  app.add_option("--out", options.out);
  CLI11_PARSE(app, argc, argv);
  std::ofstream results;
  if (!options.results.empty()) results.open(options.results);
  std::printf("%-22s %-12s %s\n", "kind", "detector", MarkerScore::header().c_str());
  bool met = true;
  for (const MarkerKind& kind : lab::cases::markerKinds()) {
    if (kind.name.find(options.only) == std::string::npos) continue;
    met = runKind(kind, options, results) && met;
  }
  return met ? 0 : 1;
}
