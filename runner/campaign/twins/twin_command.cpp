#include "runner/campaign/twins/twin_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "analyzer/analyze_run.hpp"
#include "analyzer/report_error.hpp"
#include "analyzer/twin_facts.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/files/scratch_folder.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/process/version.hpp"
#include "common/text/printable.hpp"
#include "runner/campaign/campaign_data.hpp"
#include "runner/campaign/campaign_plan.hpp"
#include "runner/campaign/local_engine.hpp"
#include "runner/campaign/sweep_progress.hpp"
#include "runner/campaign/twins/twin_comparison.hpp"
#include "runner/campaign/twins/twin_experiment.hpp"
#include "runner/campaign/twins/twin_page.hpp"
#include "runner/campaign/twins/twin_simulation.hpp"
#include "runner/live/launch.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

constexpr const char* kTwins = "twins";  ///< the campaign, below the folder of the results
constexpr const char* kReport = "report.html";
constexpr std::size_t kListedLooks = 8;

/// The folder of the results.
fs::path outOf(const TwinOptions& options, const TwinOrigin& origin) {
  if (options.out) return fs::absolute(*options.out).lexically_normal();
  if (fs::is_directory(options.run)) return origin.log;
  fs::path out = fs::absolute(options.run).lexically_normal();
  out += "-twins";
  return out;
}

std::vector<report::DrawnFigure> drawCurves(const std::string& run,
                                            const std::vector<std::string>& twins,
                                            const fs::path& folder) {
  std::vector<report::ScriptedFigure> scripts;
  for (std::size_t program = 0; program < programsOfSummary(run).size(); ++program) {
    for (const char* key : {"msd", "angular_msd"}) {
      report::ScriptedFigure figure = twinCurve(run, twins, program, key);
      if (!figure.script.empty()) scripts.push_back(std::move(figure));
    }
  }
  if (scripts.empty()) return {};
  // In a folder of its own: gnuplot follows links, and the other one may come from a stranger.
  const ScratchFolder scratch(report::makeFolderIn(folder, ".figures"));
  return report::drawFigureScripts(scripts, scratch.path());
}

/// Puts the section into the report of the run, if there is one.
void completeReport(const fs::path& out, const TwinReport& report) {
  const fs::path file = out / kReport;
  std::error_code error;
  if (!fs::exists(file, error)) return;
  const std::string page = readFileText(file, file_kinds::kText);
  replaceFile(file, withTwinSection(page, report));
}

void printLooks(const TwinReport& report) {
  fmt::print("{:<44} {:>12} {:>24} {:>6} {:>9}\n", "most unusual", "run", "95 % of twins", "z",
             "p, all");
  for (const PlacedLook* look : mostUnusual(report.comparison, kListedLooks)) {
    const LookTexts texts = textsOf(*look);
    fmt::print("{:<44} {:>12} {:>24} {:>6} {:>9}\n", printable(texts.name), texts.run,
               texts.interval, texts.z, texts.p_all);
  }
}

}  // namespace

ExitCode twin(const TwinOptions& options) {
  if (options.figures) requireProgram("gnuplot", "gnuplot-nox");
  const TwinOrigin origin = readTwinOrigin(options.run);
  const report::TwinFacts& facts = origin.facts;
  const fs::path out = outOf(options, origin);
  const fs::path folder = out / kTwins;
  fmt::print("run      {}\n", printable(options.run.string()));
  fmt::print("twins    {} of {:.6g} s in {}\n", options.count, facts.duration,
             printable(folder.string()));
  std::fflush(stdout);
  const TwinSummaries simulated =
      simulateTwins(origin, {.folder = folder, .count = options.count}, options.jobs);
  if (simulated.interrupted) {
    fmt::print("stopped  by the user; what is done stays, and the same command continues\n");
    return kFailed;
  }
  if (simulated.failed > 0) {
    fmt::print("failed   {} of {} twins: {}\n", simulated.failed, options.count,
               printable(simulated.reason));
  }
  if (simulated.summaries.size() < static_cast<std::size_t>(kFewestTwins)) {
    throw UserError(fmt::format("only {} twins have a result, expected at least {}: {}",
                                simulated.summaries.size(), kFewestTwins, simulated.reason));
  }
  const TwinReport report{origin.log.filename().string(), thisCode().text,
                          compareWithTwins(looksOf(facts.summary, simulated.summaries)),
                          origin.twins.remarks};
  std::vector<report::DrawnFigure> figures;
  if (options.figures) figures = drawCurves(facts.summary, simulated.summaries, folder);
  replaceFile(out / "twin.json", twinJson(report));
  replaceFile(out / "twins.csv", twinCsv(report));
  replaceFile(out / "twins.html", twinHtml(report, figures));
  completeReport(out, report);
  for (const std::string& remark : origin.twins.remarks)
    fmt::print("note     {}\n", printable(remark));
  printLooks(report);
  fmt::print("result   {} {}\n", printable(report.run), printable(verdictOf(report)));
  fmt::print("page     {}\n", printable((out / "twins.html").string()));
  return simulated.failed > 0 ? kFailed : kDone;
}

}  // namespace lab::runner::campaign
