#include "analyzer/run_summary.hpp"

#include "analyzer/report/record/run_record.hpp"
#include "analyzer/report/summary/summary.hpp"

namespace lab::report {

std::string summaryOfRun(const std::filesystem::path& run_or_log, const AnalyzeOptions& options) {
  return summaryJson(
      readRun(logFiles(run_or_log), {options.depth, options.stitch, options.free_times}));
}

}  // namespace lab::report
