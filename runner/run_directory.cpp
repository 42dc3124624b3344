#include "runner/run_directory.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "common/experiment_file.hpp"
#include "light/image.hpp"
#include "runner/exit_code.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

std::string compactUtc(std::int64_t utime) {
  return fmt::format("{:%Y%m%dT%H%M%SZ}", fmt::gmtime(static_cast<std::time_t>(utime / 1'000'000)));
}

std::vector<std::uint8_t> readFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw UserError(fmt::format("cannot read the image {}", path.string()));
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

std::string utcText(std::int64_t utime) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(static_cast<std::time_t>(utime / 1'000'000)));
}

fs::path makeRunDirectory(const fs::path& parent, const std::string& name, std::int64_t utime) {
  std::error_code error;
  fs::create_directories(parent, error);
  const std::string stem = name + "-" + compactUtc(utime);
  for (int number = 1; !error; ++number) {
    const fs::path path = parent / (number == 1 ? stem : fmt::format("{}-{}", stem, number));
    if (fs::create_directory(path, error)) return path;
  }
  throw UserError(fmt::format("cannot make a folder in {}: {}; choose another with --out",
                              parent.string(), error.message()));
}

void adoptImages(Experiment& experiment, const fs::path& source, const fs::path& run) {
  for (LightStep& step : experiment.light.steps) {
    for (LayerSpec& layer : step.layers) {
      if (layer.image.empty()) continue;
      const fs::path from = source / layer.image;
      const fs::path name = light::sha256(readFile(from)) + from.extension().string();
      fs::create_directories(run / files::kImages);
      fs::copy_file(from, run / files::kImages / name, fs::copy_options::skip_existing);
      layer.image = (fs::path(files::kImages) / name).string();
    }
  }
}

void writeNewFile(const fs::path& path, const std::string& text) {
  if (fs::exists(path)) throw UserError(path.string() + " exists: nothing is overwritten");
  std::ofstream file(path, std::ios::binary);
  file << text << std::flush;
  if (!file) throw UserError("cannot write " + path.string() + ": is the disk full?");
}

PreparedRun prepareRun(Experiment experiment, const fs::path& source, const fs::path& parent,
                       std::int64_t utime) {
  PreparedRun run;
  run.directory = makeRunDirectory(parent, experiment.name, utime);
  adoptImages(experiment, source, run.directory);
  run.effective = writeExperiment(experiment);
  run.experiment = std::move(experiment);
  writeNewFile(run.directory / files::kExperiment, run.effective);
  return run;
}

}  // namespace lab::runner
