#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "analyzer/laws.hpp"
#include "analyzer/laws/law_of.hpp"
#include "common/calibration/light_file.hpp"
#include "common/calibration/projector_file.hpp"
#include "common/experiment/experiment_describe.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_load.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/math/units.hpp"
#include "common/text/printable.hpp"
#include "runner/commands/commands.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

/// What the exact law says for long times: "D_r = 0.75 rad^2/s, D = 17 cm^2/s".
std::string coefficientsText(const Program& program, double wheel_base) {
  const analysis::ProgramLaw law = analysis::lawOf(program, wheel_base);
  if (!law.known()) return program.law.name.empty() ? "no closed law" : "";
  const analysis::ExactLaw exact(law);
  std::string text;
  const auto add = [&](const char* name, double value, const char* unit) {
    if (std::isfinite(value)) {
      text += fmt::format("{}{} = {:.4g} {}", text.empty() ? "" : ", ", name, value, unit);
    }
  };
  constexpr double kSquareCm = units::kCentimetre * units::kCentimetre;
  add("D_r", law->rotationalDiffusivity(), "rad^2/s");
  add("D_t", law->translationalDiffusivity() / kSquareCm, "cm^2/s");
  add("D", exact.diffusivity() / kSquareCm, "cm^2/s");
  add("L_s", exact.persistenceLength() / units::kCentimetre, "cm");
  return text;
}

}  // namespace

ExitCode check(const fs::path& file, const std::vector<std::string>& set) {
  const Experiment experiment = loadExperiment(file, set);
  if (experiment.camera.tracker == Tracker::kCamera) {
    static_cast<void>(cameraInForce(experiment, file.parent_path()));
  }
  checkProjectorFile(experiment, file.parent_path());
  static_cast<void>(activeLightCalibration(experiment, file.parent_path()));
  checkScenes(experiment, file.parent_path());
  const auto coefficients = [&](const Program& program) {
    return coefficientsText(program, experiment.hardware.diameter);
  };
  fmt::print("{}", printableLines(describeExperiment(experiment, coefficients)));
  const std::string problem = loadProblem(experiment, std::thread::hardware_concurrency());
  if (!problem.empty()) fmt::print("warning       {}\n", printable(problem));
  return kDone;
}

}  // namespace lab::runner
