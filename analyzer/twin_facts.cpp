#include "analyzer/twin_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "analyzer/report/record/run_record.hpp"
#include "analyzer/report/summary/summary.hpp"
#include "analyzer/report_error.hpp"

namespace lab::report {
namespace {

/// The mean of a curve's noise over the programs, by their windows; nothing without one.
std::optional<double> meanNoise(const RunRecord& record,
                                std::vector<analysis::CurvePoint> analysis::Curves::*curve) {
  double sum = 0;
  double windows = 0;
  for (const analysis::FeedResult& result : record.results) {
    if (result.result.robot != analysis::kPool) continue;
    const auto& points = result.result.curves.*curve;
    if (points.empty() || !std::isfinite(points.front().noise)) continue;
    sum += points.front().noise * points.front().windows;
    windows += points.front().windows;
  }
  if (!(windows > 0)) return {};
  return sum / windows;
}

/// sigma of an offset that is `factor` sigma^2. A negative offset is one that was not resolved.
std::optional<double> sigmaOf(const std::optional<double>& offset, double factor) {
  if (!offset) return {};
  return std::sqrt(std::max(0.0, *offset) / factor);
}

void readFrames(const RunRecord& record, TwinFacts& facts) {
  std::set<std::int32_t> robots;
  for (const RobotSpec& robot : facts.experiment.robots) robots.insert(robot.id);
  for (std::size_t i = 0; i < record.tracks.frames.size(); ++i) {
    const double t = record.seconds(record.tracks.frames[i].utime);
    if (t < 0 || t > facts.duration) continue;
    RecordedFrame frame{t, {}};
    std::set<std::int32_t> seen;
    for (std::size_t r = record.tracks.frames[i].first_row; r < record.tracks.endOf(i); ++r) {
      const TrackRow& row = record.tracks.rows[r];
      seen.insert(row.robot);
      if (!facts.first_poses.contains(row.robot)) {
        facts.first_poses[row.robot] = {static_cast<double>(row.x), static_cast<double>(row.y),
                                        static_cast<double>(row.theta)};
      }
      record.tracks.rows.keepNear(r);
    }
    std::ranges::set_difference(robots, seen, std::back_inserter(frame.missing));
    facts.frames.push_back(std::move(frame));
  }
}

}  // namespace

TwinFacts readTwinFacts(const std::filesystem::path& run_or_log, const AnalyzeOptions& options) {
  const RunRecord record =
      readRun(logFiles(run_or_log), {options.depth, options.stitch, options.free_times});
  if (!record.experiment) {
    throw ReportError(fmt::format("{}: {}; twins need the experiment", run_or_log.string(),
                                  record.experiment_problem));
  }
  TwinFacts facts;
  facts.experiment = *record.experiment;
  facts.ended = record.ended;
  facts.duration = std::min(record.duration(), facts.experiment.duration);
  readFrames(record, facts);
  if (facts.frames.empty()) {
    throw ReportError(run_or_log.string() +
                      ": no TRACKED_FRAME in this log, so there is nothing to compare with twins");
  }
  for (const StepRecord& step : record.steps) {
    facts.steps.push_back({step.number, step.label, record.seconds(step.commanded_utime)});
  }
  facts.position_noise = sigmaOf(meanNoise(record, &analysis::Curves::msd), 4);
  facts.heading_noise = sigmaOf(meanNoise(record, &analysis::Curves::angular_msd), 2);
  facts.version = record.version;
  facts.marks = record.marks.size();
  facts.summary = summaryJson(record);
  return facts;
}

}  // namespace lab::report
