// CSV files of poses, as `lab analyze` reads them. The first byte chooses options and program.
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>

#include "analyzer/report/html/report_page.hpp"
#include "analyzer/report/poses/pose_file.hpp"
#include "analyzer/report/poses/pose_run.hpp"
#include "analyzer/report/sections/segments.hpp"
#include "analyzer/report/summary/findings.hpp"
#include "analyzer/report/summary/summary.hpp"
#include "analyzer/report/summary/trajectories.hpp"
#include "analyzer/report_error.hpp"
#include "tests/fuzz/input.hpp"

namespace lab::fuzz {
namespace {

report::PoseProgram programOf(unsigned number) {
  switch (number) {
    case 1:
      return {"abp", {"v_cm_s=3", "epsilon_s=0.5", "eta_rad_s=3"}};
    case 2:
      return {"rtp", {"v_cm_s=5", "gamma_per_s=3", "tau_t_s=0.5"}};
    case 3:
      return {"bp", {"V_cm_s=7", "epsilon_s=0.2"}};
    default:
      return {};
  }
}

void analyze(unsigned options, const std::string& text) {
  std::istringstream stream(text);
  const report::PoseFile poses =
      report::readPoses(stream, "fuzz.csv",
                        {.scale = options % 2 != 0 ? std::optional(0.01) : std::nullopt,
                         .fps = options / 2 % 2 != 0 ? std::optional(30.0) : std::nullopt});
  const report::RunRecord record =
      report::poseRun(poses, "fuzz", programOf(options / 4 % 4), {analysis::Depth::kLive, true});
  static_cast<void>(report::summaryJson(record));
  std::ostringstream trajectories;
  report::writeTrajectories(record, trajectories);
  static_cast<void>(report::segmentsCsv(record));
  static_cast<void>(report::reportHtml(record, {}));
  static_cast<void>(report::headlines(record));
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  lab::fuzz::Input input(bytes, size);
  const auto options = input.number<std::uint8_t>();
  try {
    lab::fuzz::analyze(options, input.restAsText());
  } catch (const lab::report::ReportError&) {
  }
  return 0;
}
