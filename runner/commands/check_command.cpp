#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "analyzer/analysis_feed.hpp"
#include "analyzer/law_knowledge.hpp"
#include "analyzer/laws.hpp"
#include "common/calibration/light_file.hpp"
#include "common/calibration/projector_file.hpp"
#include "common/experiment/experiment_describe.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_load.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/text/printable.hpp"
#include "runner/commands/commands.hpp"
#include "runner/commands/run_command.hpp"
#include "runner/live/dashboard_process.hpp"
#include "runner/live/launch.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {
namespace fs = std::filesystem;

ExitCode check(const fs::path& file, const std::vector<std::string>& set) {
  const Experiment experiment = loadExperiment(file, set, analysis::lawKnowledge());
  checkFiles(experiment, file.parent_path());
  const auto coefficients = [&](const Program& program) {
    const double wheel_base = experiment.hardware.diameter;
    const std::string measured = analysis::coefficientsText(program, wheel_base);
    return measured + (measured.empty() ? "" : "; ") + analysis::referenceText(program, wheel_base);
  };
  fmt::print("{}", printableLines(describeExperiment(experiment, coefficients)));
  const bool dashboard = wantsDashboard(std::nullopt, false, std::getenv("CI"));
  for (const std::string& problem :
       {loadProblem(experiment, std::thread::hardware_concurrency(), dashboard),
        diskProblem(experiment, RunOptions().out, "give `lab run` another folder with --runs")}) {
    if (!problem.empty()) fmt::print("warning       {}\n", printable(problem));
  }
  return kDone;
}

}  // namespace lab::runner
