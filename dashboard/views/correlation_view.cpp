#include "dashboard/views/correlation_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/math/units.hpp"

namespace lab::dashboard {
namespace {

using units::kNan;

constexpr double kFrame = 0.05;  // [s] between the frames that are used
constexpr double kMinStep = 2 * kFrame;
constexpr double kTolerance = 0.3;     // of the time between two headings, in steps
constexpr double kFirstBlock = 2;      // in units of the longest lag
constexpr std::size_t kMinBlocks = 6;  // for a standard error
constexpr double kMinPairs = 10;

bool isPersistent(const analysis::ProgramLaw& law) {
  return law->constantSpeed().value_or(0) > 0 && law->rotationalDiffusivity() > 0;
}

/// A multiple of the frame period, so that the lags are exact.
double stepOf(const analysis::ProgramLaw& law) {
  const double step =
      HeadingCorrelation::kReach / law->rotationalDiffusivity() / HeadingCorrelation::kLags;
  return std::max(kMinStep, std::round(step / kFrame) * kFrame);
}

}  // namespace

HeadingCorrelation::HeadingCorrelation(const analysis::ProgramLaw& law)
    : law_(law), step_(stepOf(law)), block_(kFirstBlock * step_ * kLags) {}

void HeadingCorrelation::Sums::add(const Sums& other) {
  for (std::size_t k = 0; k < kLags; ++k) {
    cosines[k] += other.cosines[k];
    times[k] += other.times[k];
    pairs[k] += other.pairs[k];
  }
}

HeadingCorrelation::Row& HeadingCorrelation::rowAt(double time) {
  if (begin_ < 0) begin_ = time;
  const auto number = [&] {
    return static_cast<std::size_t>(std::max(0.0, (time - begin_) / block_));
  };
  while (number() >= kMaxTimes) {
    for (std::size_t i = 0; 2 * i < rows_.size(); ++i) {
      Row merged = rows_[2 * i];
      for (std::size_t g = 0; g < kGroups && 2 * i + 1 < rows_.size(); ++g) {
        merged[g].add(rows_[2 * i + 1][g]);
      }
      rows_[i] = merged;
    }
    rows_.resize((rows_.size() + 1) / 2);
    block_ *= 2;
  }
  if (rows_.size() <= number()) rows_.resize(number() + 1);
  return rows_[number()];
}

void HeadingCorrelation::add(int robot, const analysis::Sample& sample) {
  if (!std::isfinite(sample.theta)) return;
  std::deque<Heading>& before = headings_[robot];
  const Heading now{sample.free_time, sample.theta, sample.angular_segment};
  if (!before.empty() && before.back().segment != now.segment) before.clear();
  constexpr double kJitter = 0.02;  // [s] a frame may be a little early
  if (!before.empty() && now.time - before.back().time < step_ - kJitter) return;
  Sums& sums = rowAt(sample.time)[static_cast<std::size_t>(robot < 0 ? -robot : robot) % kGroups];
  for (const Heading& then : before) {
    const double steps = (now.time - then.time) / step_;
    const double nearest = std::round(steps);
    if (nearest < 1 || nearest > kLags || std::abs(steps - nearest) > kTolerance) continue;
    const auto k = static_cast<std::size_t>(nearest) - 1;
    sums.cosines[k] += std::cos(now.theta - then.theta);
    sums.times[k] += now.time - then.time;
    sums.pairs[k] += 1;
  }
  before.push_back(now);
  if (before.size() > kLags) before.pop_front();
}

LengthCurve HeadingCorrelation::curve(double speed) const {
  Sums all;
  std::vector<const Sums*> blocks;
  for (const Row& row : rows_) {
    for (const Sums& sums : row) {
      if (sums.pairs[0] == 0) continue;
      all.add(sums);
      blocks.push_back(&sums);
    }
  }
  LengthCurve curve;
  const double programmed = law_.program()->meanSpeed();
  if (!(speed > 0)) speed = programmed;
  for (std::size_t k = 0; k < kLags; ++k) {
    if (all.pairs[k] < kMinPairs) continue;
    const double value = all.cosines[k] / all.pairs[k];
    const double lag = all.times[k] / all.pairs[k];
    // Jackknife for blocks of unequal size: the sum of the squared contributions to the mean.
    double sum = 0;
    std::size_t used = 0;
    for (const Sums* block : blocks) {
      if (block->pairs[k] == 0) continue;
      const double off = (block->cosines[k] - value * block->pairs[k]) / all.pairs[k];
      sum += off * off;
      ++used;
    }
    const double count = static_cast<double>(used);
    curve.length.push_back(speed * lag);
    curve.value.push_back(value);
    curve.sigma.push_back(used < kMinBlocks ? kNan : std::sqrt(sum * count / (count - 1)));
    curve.exact.push_back(law_.velocityCorrelation(speed * lag / programmed) /
                          (programmed * programmed));
    curve.windows.push_back(all.pairs[k]);
  }
  return curve;
}

analysis::AnalysisFeed* CorrelationView::feed() {
  if (feed_ || !wanted_ || !run_info_.known()) return feed_.get();
  const Experiment& experiment = run_info_.experiment();
  const double wheel_base = experiment.hardware.diameter;
  std::vector<std::pair<analysis::ProgramLaw, std::string>> laws;
  for (const auto& [name, program] : experiment.programs) {
    const analysis::ProgramLaw law = analysis::lawOf(program, wheel_base);
    if (isPersistent(law)) laws.emplace_back(law, name);
  }
  wanted_ = !laws.empty();
  if (!wanted_) return nullptr;
  feed_ = std::make_unique<analysis::AnalysisFeed>(experiment);
  feed_->samplesOnly([this, laws = std::move(laws)](int robot, const analysis::ProgramLaw& law,
                                                    const analysis::Sample& sample) {
    for (const auto& [known, name] : laws) {
      if (!(known == law)) continue;
      programs_.try_emplace(name, law).first->second.add(robot, sample);
      return;
    }
  });
  return feed_.get();
}

void CorrelationView::take(const robot_status_t& status) {
  if (auto* const to = feed()) to->take(status);
}

void CorrelationView::take(const tracked_frame_t& frame) {
  if (auto* const to = feed()) to->take(frame);
}

void CorrelationView::clear() {
  feed_.reset();
  programs_.clear();
  wanted_ = true;
}

std::optional<LengthCurve> CorrelationView::curve(const std::string& program, double speed) const {
  const auto found = programs_.find(program);
  if (found == programs_.end()) return std::nullopt;
  const auto& programs = run_info_.experiment().programs;
  const auto spec = programs.find(program);
  if (spec == programs.end()) return std::nullopt;  // it belongs to the previous experiment
  LengthCurve curve = found->second.curve(speed);
  if (curve.length.empty()) return std::nullopt;
  return curve;
}

}  // namespace lab::dashboard
