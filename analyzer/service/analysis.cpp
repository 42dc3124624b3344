#include "analyzer/service/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "analyzer/curves/lags.hpp"
#include "analyzer/curves/reference_comparison.hpp"
#include "analyzer/curves/robot_scatter.hpp"
#include "analyzer/service/bootstrap_results.hpp"
#include "light/median.hpp"

namespace lab::analysis {
namespace {

constexpr std::size_t kFramesForPeriod = 20;
constexpr double kShortestPeriod = 1e-4;        // s, shorter than that of any camera
constexpr double kUnbiasedShare = 0.1;          // of the median dwell time
constexpr std::size_t kMaxDwellTimes = 100000;  // limit of memory, per program
constexpr int kLiveFilms = 120;                 // of the reference of a program
constexpr int kLiveFilmsPerCall = 8;
constexpr double kLiveFilmFrames = 30000;

}  // namespace

namespace {

/// The intervals of all robots together contain the scatter between robots.
void widenRuns(RunStatistics& pool, const std::vector<ProgramResult>& robots) {
  std::vector<const std::vector<Estimate>*> estimates;
  std::vector<double> weights;
  for (const ProgramResult& robot : robots) {
    if (!robot.runs || !robot.runs->problem.empty()) continue;
    estimates.push_back(&robot.runs->estimates);
    weights.push_back(robot.runs->observed);
  }
  widenByRobots(pool.estimates, estimates, weights);
}

}  // namespace

Analysis::Robot* Analysis::robotOf(int id) {
  const auto known = robots_.find(id);
  if (known != robots_.end()) return &known->second;
  if (robots_.size() >= kMostRobots) {
    ++counters_.left_out;
    return nullptr;
  }
  return &robots_.try_emplace(id, config_.stitcher).first->second;
}

int Analysis::programOf(const ProgramLaw& law) {
  const auto found = std::find(programs_.begin(), programs_.end(), law);
  if (found != programs_.end()) {
    return static_cast<int>(found - programs_.begin());
  }
  const bool free =
      !law.known() ? config_.without_law : law->isSimulated() || !law->whyNoVerdict().empty();
  if (!free && !ExactLaw(law).exists()) {
    return -1;
  }
  if (programs_.size() >= kMostPrograms) {
    ++counters_.left_out;
    return -1;
  }
  programs_.push_back(law);
  dwell_times_.emplace_back();
  return static_cast<int>(programs_.size()) - 1;
}

void Analysis::addTelemetry(int robot, const ProgramLaw& law, RobotTelemetry telemetry) {
  ++counters_.telemetry;
  telemetry.program = programOf(law);
  telemetry.sense_distance = senseDistance(law);
  Robot* const target = robotOf(robot);
  if (target == nullptr) return;
  recordDwellTime(*target, telemetry);
  target->stitcher.addTelemetry(telemetry, samples_);
  take(robot, *target);
}

void Analysis::recordDwellTime(Robot& robot, const RobotTelemetry& telemetry) {
  // The start of an epoch, converted from the robot's clock, may jitter; its number does not.
  const bool old =
      telemetry.program_epoch < robot.epoch && telemetry.program_start <= robot.program_start;
  if (telemetry.program_epoch == robot.epoch || old || !std::isfinite(telemetry.program_start)) {
    return;
  }
  if (robot.program >= 0) {
    std::vector<float>& durations = dwell_times_[static_cast<std::size_t>(robot.program)];
    if (durations.size() < kMaxDwellTimes) {
      durations.push_back(static_cast<float>(telemetry.program_start - robot.program_start));
    }
  }
  robot.epoch = telemetry.program_epoch;
  robot.program = telemetry.program;
  robot.program_start = telemetry.program_start;
}

void Analysis::addFrame(const Frame& frame) {
  ++counters_.frames;
  if (config_.frame_period > 0) {
    dispatch(frame);
    return;
  }
  first_frames_.push_back(frame);
  measurePeriod(false);
}

void Analysis::measurePeriod(bool force) {
  if (config_.frame_period > 0 || (!force && first_frames_.size() < kFramesForPeriod)) {
    return;
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < first_frames_.size(); ++i) {
    const double step = first_frames_[i].time - first_frames_[i - 1].time;
    if (step > 0) {
      steps.push_back(step);
    }
  }
  if (steps.empty()) {
    first_frames_.clear();
    return;
  }
  config_.frame_period = std::max(medianOf(steps), kShortestPeriod);
  for (const Frame& frame : std::exchange(first_frames_, {})) {
    dispatch(frame);
  }
}

void Analysis::dispatch(const Frame& frame) {
  std::vector<int>& ids = frame_robots_;
  ids.clear();
  for (const FramePose& pose : frame.poses) ids.push_back(pose.robot);
  std::ranges::sort(ids);
  const bool any_twice = std::ranges::adjacent_find(ids) != ids.end();
  for (const FramePose& pose : frame.poses) {
    if (any_twice && std::ranges::count(ids, pose.robot) > 1) {
      ++counters_.duplicate_robots;
      continue;
    }
    Robot* const robot = robotOf(pose.robot);
    if (robot == nullptr) continue;
    robot->stitcher.addFrame({frame.time, frame.frame, pose.x, pose.y, pose.theta, pose.sigma,
                              pose.sigma_theta, pose.valid},
                             samples_);
    take(pose.robot, *robot);
  }
}

ProgramAnalysis* Analysis::analysisOf(Robot& robot, int program) {
  const auto known = robot.programs.find(program);
  if (known != robot.programs.end()) return known->second.get();
  if (of_robots_ >= kMostOfRobots) return nullptr;
  ++of_robots_;
  auto analysis = std::make_unique<ProgramAnalysis>(programs_[static_cast<std::size_t>(program)],
                                                    config_.frame_period, config_.max_lag);
  if (config_.compare_joins) analysis->collectJoins(config_.frame_period, config_.max_lag);
  if (config_.find_runs) analysis->collectRuns(config_.frame_period);
  if (config_.whole_motion) analysis->collectWhole(config_.frame_period, config_.max_lag);
  return robot.programs.emplace(program, std::move(analysis)).first->second.get();
}

void Analysis::takeReports(int id, Robot& robot) {
  for (const FrameReport& frame : robot.stitcher.takeReports()) {
    if (config_.whole_motion && frame.program >= 0 && frame.state != FrameState::kLost) {
      ProgramAnalysis* const program = analysisOf(robot, frame.program);
      if (program != nullptr) program->addFrame(frame);
    }
    if (frame_sink_) frame_sink_(id, frame);
  }
}

void Analysis::take(int id, Robot& robot) {
  if (config_.stitcher.report_frames) takeReports(id, robot);
  for (const Sample& sample : samples_) {
    const ProgramLaw& law = programs_[static_cast<std::size_t>(sample.program)];
    if (config_.samples_only) {
      if (sink_) {
        sink_(id, law, sample);
      }
      continue;
    }
    ProgramAnalysis* const program = analysisOf(robot, sample.program);
    if (program == nullptr) {
      ++counters_.left_out;
      continue;
    }
    program->add(sample);
    if (sink_) {
      sink_(id, law, sample);
    }
  }
  samples_.clear();
  for (const Piece& piece : robot.stitcher.takePieces()) {
    if (piece_sink_) {
      piece_sink_(id, programs_[static_cast<std::size_t>(piece.program)], piece);
    }
  }
}

void Analysis::flush() {
  measurePeriod(true);
  for (auto& [id, robot] : robots_) {
    robot.stitcher.flush(samples_);
    take(id, robot);
  }
}

double Analysis::medianDwellTime(int program) const {
  std::vector<float> durations = dwell_times_[static_cast<std::size_t>(program)];
  if (durations.empty()) {
    return 0;
  }
  return static_cast<double>(medianOf(durations));
}

void Analysis::simulateReferences() {
  if (!(config_.frame_period > 0)) return;
  for (std::size_t key = 0; key < programs_.size(); ++key) {
    const ProgramLaw& law = programs_[key];
    if (!law->isSimulated()) continue;
    const int program = static_cast<int>(key);
    auto found = references_.find(program);
    if (found == references_.end()) {
      FilmPlan plan;
      plan.law = law;
      plan.frame_period = config_.frame_period;
      plan.lags = makeLagGrid(config_.frame_period, config_.max_lag, law);
      plan.duration = kLiveFilmFrames * config_.frame_period;
      plan.films = kLiveFilms;
      found = references_.emplace(program, FilmReference(plan)).first;
    }
    found->second.advance(kLiveFilmsPerCall);
  }
}

void Analysis::judgeLive(int program, const BlockData& data, const CurveOptions& options,
                         ProgramResult& result) const {
  if (!result.law->isSimulated()) return;
  const auto found = references_.find(program);
  if (found != references_.end() && found->second.complete()) {
    compareWithFilms(result.curves, found->second, result.law, data, options);
    judgeMotion(result);
    return;
  }
  result.no_verdict = "The reference is being simulated.";
  for (Estimate& estimate : result.estimates) estimate.note += "; reference being simulated";
}

ProgramResult Analysis::liveResult(LiveResult& last, int program, std::int64_t samples,
                                   const ProgramTally& tally, const CurveOptions& options,
                                   const std::function<const BlockData&()>& data) const {
  const auto reference = references_.find(program);
  const bool judged = reference != references_.end() && reference->second.complete();
  if (!last.isOf(samples, options.unbiased_lag, judged)) {
    const ProgramLaw& law = programs_[static_cast<std::size_t>(program)];
    last = {samples, options.unbiased_lag, judged, analyse(law, data(), tally, options)};
    judgeLive(program, data(), options, last.result);
  }
  setTally(last.result, tally);
  judgeMotion(last.result);  // depends on the share of contacts
  return last.result;
}

std::vector<ProgramResult> Analysis::programResults(int program, Depth depth,
                                                    const CurveOptions& options,
                                                    const std::function<void()>& meanwhile) const {
  const ProgramLaw& law = programs_[static_cast<std::size_t>(program)];
  std::vector<ProgramResult> results(1);  // the pool is the first one
  std::vector<ProgramResult> each;
  std::vector<const ProgramAnalysis*> robots;
  ProgramTally sum;
  std::int64_t samples = 0;
  JoinBlocks joins;
  WholeSums whole;
  std::vector<FoundRuns> runs;
  const auto resultOf = [&](LiveResult& last, std::int64_t of_samples, const ProgramTally& tally,
                            const auto& data) {
    return depth == Depth::kLive ? liveResult(last, program, of_samples, tally, options, data)
                                 : analyse(law, data(), tally, options, depth);
  };
  for (const auto& [id, robot] : robots_) {
    const auto found = robot.programs.find(program);
    if (found == robot.programs.end()) continue;
    const ProgramAnalysis& own = *found->second;
    const ProgramTally tally = robot.stitcher.tally(program);
    sum += tally;
    samples += own.samples();
    robots.push_back(&own);
    each.push_back(resultOf(own.live(), own.samples(), tally,
                            [&own]() -> const BlockData& { return own.data(); }));
    each.back().robot = id;
    if (meanwhile) meanwhile();
    if (own.whole()) {
      const WholeSums own_whole = own.whole()->sums();
      each.back().whole = own_whole.motion();
      whole.pool(own_whole);
    }
    if (own.joins()) {
      const JoinBlocks own_joins = own.joins()->blocks();
      each.back().joins = compareJoins(own_joins);
      joins.pool(own_joins);
    }
    if (own.runs()) {
      runs.push_back(own.runs()->find());
      each.back().runs = runStatistics(law, {&runs.back()});
    }
  }
  if (each.empty()) return {};
  BlockData pool;
  const auto pooled = [&]() -> const BlockData& {
    for (std::size_t i = pool.tracks.size(); i < robots.size(); ++i) pool.pool(robots[i]->data());
    return pool;
  };
  // A pool of one robot equals that robot.
  results.front() =
      each.size() == 1 ? each.front() : resultOf(pools_[program], samples, sum, pooled);
  results.front().robot = kPool;
  if (depth == Depth::kFull) {
    std::vector<const BlockData*> data;
    for (const ProgramAnalysis* own : robots) data.push_back(&own->data());
    addBootstrapResults(results.front(), pooled(), each, data, options);
  }
  if (!runs.empty()) {
    std::vector<const FoundRuns*> all;
    for (const FoundRuns& own : runs) all.push_back(&own);
    results.front().runs = runStatistics(law, all);
    if (each.size() > 1) widenRuns(*results.front().runs, each);
  }
  if (!whole.blocks.lags.empty()) results.front().whole = whole.motion();
  if (!joins.lags.empty()) results.front().joins = compareJoins(joins);
  std::ranges::move(each, std::back_inserter(results));
  return results;
}

std::vector<ProgramResult> Analysis::results(Depth depth,
                                             const std::function<void()>& meanwhile) const {
  std::vector<ProgramResult> results;
  for (std::size_t key = 0; key < programs_.size(); ++key) {
    const int program = static_cast<int>(key);
    CurveOptions options = config_.curves;
    options.unbiased_lag = spatial_light_ ? kUnbiasedShare * medianDwellTime(program) : 0;
    std::ranges::move(programResults(program, depth, options, meanwhile),
                      std::back_inserter(results));
  }
  return results;
}

StitcherCounters Analysis::robotCounters(int robot) const {
  const auto found = robots_.find(robot);
  return found == robots_.end() ? StitcherCounters{} : found->second.stitcher.counters();
}

std::vector<int> Analysis::robots() const {
  std::vector<int> ids;
  for (const auto& entry : robots_) {
    ids.push_back(entry.first);
  }
  return ids;
}

}  // namespace lab::analysis
