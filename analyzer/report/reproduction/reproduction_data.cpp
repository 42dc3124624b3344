#include "analyzer/report/reproduction/reproduction_data.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "analyzer/analysis_feed.hpp"
#include "analyzer/log_source.hpp"
#include "analyzer/report/record/run_record.hpp"
#include "analyzer/report_error.hpp"
#include "common/math/units.hpp"

namespace lab::report {
namespace {

using analysis::Sample;
using units::kCm;

constexpr std::size_t kPathPoints = 3000;
constexpr double kCloseUp = 12;         // [s]
constexpr double kSpeedBaseline = 0.1;  // [s]
constexpr int kBlocks = 20;
constexpr int kLengths = 48;
constexpr double kReach = 4;  // persistence lengths up to which C(l) is measured

std::vector<Sample> samplesOf(const std::vector<std::filesystem::path>& files,
                              const Experiment& experiment) {
  analysis::AnalysisFeed feed(experiment);
  std::vector<Sample> samples;
  feed.onSample([&samples](int, const Sample& sample) {
    if (sample.program >= 0) samples.push_back(sample);
  });
  MessageSinks sinks;
  sinks.frame = [&feed](const tracked_frame_t& frame) { feed.take(frame); };
  sinks.robots = [&feed](const robot_status_t& status) { feed.take(status); };
  sinks.light = [&feed](const light_status_t& status) { feed.take(status); };
  sinks.event = [](const experiment_event_t&) {};
  sinks.service = [](const service_status_t&) {};
  static_cast<void>(readMessages(files, sinks));
  feed.flush();
  return samples;
}

void takePath(const std::vector<Sample>& samples, RecordingData& recording) {
  const double begin = samples.front().free_time;
  const std::size_t stride = std::max<std::size_t>(1, samples.size() / kPathPoints);
  for (std::size_t i = 0; i < samples.size(); i += stride) {
    recording.path.push_back(
        {samples[i].free_time - begin, samples[i].x * kCm, samples[i].y * kCm});
  }
  const double middle = begin + (samples.back().free_time - begin) / 2;
  for (const Sample& s : samples) {
    if (s.free_time < middle || s.free_time > middle + kCloseUp) continue;
    recording.close_up.push_back({s.free_time - begin, s.x * kCm, s.y * kCm});
  }
}

void takeRuns(const std::vector<Sample>& samples, RecordingData& recording) {
  const double begin = samples.front().free_time;
  std::size_t from = 0;
  for (std::size_t to = 0; to < samples.size(); ++to) {
    while (samples[to].free_time - samples[from].free_time > kSpeedBaseline + 1e-4) ++from;
    const double dt = samples[to].free_time - samples[from].free_time;
    if (dt < 0.9 * kSpeedBaseline || samples[to].segment != samples[from].segment) continue;
    const double distance =
        std::hypot(samples[to].x - samples[from].x, samples[to].y - samples[from].y);
    recording.speeds.push_back({samples[to].free_time - dt / 2 - begin, distance / dt * kCm});
  }
  // The robot counts a tumble at its beginning, and run time does not increase while it tumbles:
  // the smallest run time with one count is that of all runs before this tumble.
  std::map<std::int64_t, double> before;
  for (const Sample& s : samples) {
    const auto found = before.try_emplace(s.tumble_count, s.run_time).first;
    found->second = std::min(found->second, s.run_time);
  }
  double last = 0;
  std::int64_t last_count = -2;
  for (const auto& [count, run_time] : before) {
    // The first count may begin within a run.
    if (count == last_count + 1 && last_count != before.begin()->first) {
      recording.run_times.push_back(run_time - last);
    }
    last = run_time;
    last_count = count;
  }
}

/// Least squares of exp(-l/L) to C(l), by golden section in log L. @return L in the unit of l.
double fitLength(const std::vector<double>& lengths, const std::vector<double>& values) {
  const auto misfit = [&](double log_length) {
    double sum = 0;
    for (std::size_t k = 0; k < lengths.size(); ++k) {
      const double off = values[k] - std::exp(-lengths[k] / std::exp(log_length));
      sum += off * off;
    }
    return sum;
  };
  constexpr double kGolden = 0.6180339887498949;
  double low = std::log(lengths.back() / 200);
  double high = std::log(lengths.back() * 20);
  while (high - low > 1e-9) {
    const double a = high - kGolden * (high - low);
    const double b = low + kGolden * (high - low);
    (misfit(a) < misfit(b) ? high : low) = misfit(a) < misfit(b) ? b : a;
  }
  return std::exp((low + high) / 2);
}

struct CorrelationSums {
  std::vector<double> cosines = std::vector<double>(kLengths);
  std::vector<double> times = std::vector<double>(kLengths);
  std::vector<double> counts = std::vector<double>(kLengths);
};

/// C(l) along the stitched track. The speed is constant, so l is speed times time: a path
/// length summed from frames would be dominated by tracker noise.
void takeCorrelation(const std::vector<Sample>& samples, double speed, RecordingData& recording) {
  const analysis::ProgramLaw& law = recording.result.law;
  const double period = (samples.back().free_time - samples.front().free_time) /
                        static_cast<double>(samples.size() - 1);
  const double persistence = 1 / law->rotationalDiffusivity();  // [s]
  std::vector<std::size_t> offsets;
  for (int k = 0; k < kLengths; ++k) {
    offsets.push_back(
        static_cast<std::size_t>(std::lround(kReach * persistence / period * k / (kLengths - 1))));
  }
  if (offsets.back() >= samples.size() / 4) return;  // too short a recording
  std::vector<CorrelationSums> blocks(kBlocks);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    CorrelationSums& block = blocks[i * kBlocks / samples.size()];
    for (std::size_t k = 0; k < offsets.size(); ++k) {
      const std::size_t j = i + offsets[k];
      if (j >= samples.size() || samples[j].angular_segment != samples[i].angular_segment) break;
      block.cosines[k] += std::cos(samples[j].theta - samples[i].theta);
      block.times[k] += samples[j].free_time - samples[i].free_time;
      block.counts[k] += 1;
    }
  }
  // All blocks, then all but one of them: the jackknife.
  std::vector<std::vector<double>> curves;
  std::vector<double> fits;
  std::vector<double> lengths(offsets.size());
  for (int left_out = -1; left_out < kBlocks; ++left_out) {
    std::vector<double> curve;
    for (std::size_t k = 0; k < offsets.size(); ++k) {
      double cosines = 0;
      double times = 0;
      double counts = 0;
      for (int b = 0; b < kBlocks; ++b) {
        if (b == left_out) continue;
        const CorrelationSums& block = blocks[static_cast<std::size_t>(b)];
        cosines += block.cosines[k];
        times += block.times[k];
        counts += block.counts[k];
      }
      if (!(counts > 0)) return;
      if (left_out < 0) lengths[k] = speed * times / counts * kCm;
      curve.push_back(cosines / counts);
    }
    fits.push_back(fitLength(lengths, curve));
    curves.push_back(std::move(curve));
  }
  const auto jackknife = [](const auto& value) {
    double mean = 0;
    double sum = 0;
    for (std::size_t b = 1; b <= kBlocks; ++b) mean += value(b) / kBlocks;
    for (std::size_t b = 1; b <= kBlocks; ++b) sum += (value(b) - mean) * (value(b) - mean);
    return std::sqrt(sum * (kBlocks - 1) / kBlocks);
  };
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    recording.correlation.push_back(
        {lengths[k], curves[0][k], jackknife([&](std::size_t b) { return curves[b][k]; })});
  }
  recording.fitted_length = fits[0];
  recording.fitted_length_sigma = jackknife([&](std::size_t b) { return fits[b]; });
}

double measuredSpeed(const analysis::ProgramResult& result) {
  for (const analysis::Estimate& estimate : result.estimates) {
    if (estimate.name == "v" && std::isfinite(estimate.value)) return estimate.value;
  }
  return result.law->meanSpeed();
}

}  // namespace

RecordingContents contentsFor(const std::vector<PaperPanel>& panels, const PaperSet& set) {
  RecordingContents wants;
  for (const PaperPanel& panel : panels) {
    if (std::find(panel.curves.begin(), panel.curves.end(), set.id) == panel.curves.end()) continue;
    wants.path = wants.path || panel.kind == PanelKind::kTrajectory;
    wants.correlation = wants.correlation || panel.kind == PanelKind::kPersistence;
    wants.runs = wants.runs || panel.kind == PanelKind::kRunTumble;
  }
  return wants;
}

RecordingData readRecording(const std::filesystem::path& run, const RecordingContents& wants,
                            analysis::Depth depth) {
  const std::vector<std::filesystem::path> files = logFiles(run);
  const RunRecord record = readRun(files, {.depth = depth});
  RecordingData recording;
  const auto pool = std::find_if(record.results.begin(), record.results.end(), [](const auto& one) {
    return one.result.robot == analysis::kPool;
  });
  if (pool == record.results.end()) {
    throw ReportError(run.string() + ": no robot ran a program, so there is nothing to compare");
  }
  recording.result = pool->result;
  for (const Remark& fault : record.faults) recording.faults.push_back(fault.text);
  if (!wants.path && !wants.correlation && !wants.runs) return recording;
  const std::vector<Sample> samples = samplesOf(files, record.experimentOrDefault());
  if (samples.size() < 2) return recording;
  if (wants.path) takePath(samples, recording);
  if (wants.correlation) takeCorrelation(samples, measuredSpeed(recording.result), recording);
  if (wants.runs) takeRuns(samples, recording);
  return recording;
}

}  // namespace lab::report
