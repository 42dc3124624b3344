#include "analyzer/runs/run_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analyzer/curves/clock_error.hpp"
#include "analyzer/curves/statistics.hpp"
#include "common/math/angle.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

using units::kNan;

constexpr double kNormal95 = 1.959964;
constexpr double kBarsPerMean = 4;  // bars per mean run time
constexpr std::size_t kMostBars = 60;
constexpr double kFewestPerBar = 3;
constexpr double kMostTurnBars = 36;
constexpr double kPerTurnBar = 25;
constexpr std::uint64_t kSeed = 0x52554e53;

/// The runs of all robots, as input of the likelihood.
struct Pool {
  double ended = 0;
  double run_time = 0;  ///< Time of detected runs, s.
  double beyond = 0;    ///< The same, less `shortest` for each run.
  struct Hidden {
    double count;
    double shortest;
  };
  std::vector<Hidden> hidden;
  double hidden_count = 0;

  /// The derivative of the log likelihood.
  [[nodiscard]] double score(double gamma) const {
    double score = ended / gamma - run_time;
    for (const Hidden& one : hidden) {
      score += one.count * one.shortest / std::expm1(gamma * one.shortest);
    }
    return score;
  }

  [[nodiscard]] double rate() const {
    double low = 0.1 * ended / run_time;
    double high = 10 * (ended + hidden_count) / run_time;
    for (int i = 0; i < 80; ++i) {
      const double middle = 0.5 * (low + high);
      (score(middle) > 0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
};

/// The mean over robots, weighted by the number of single values: inverse variances would not be
/// weights where a camera without noise leaves none, and would prefer some robots by chance.
Measured weighted(const std::vector<const FoundRuns*>& robots, Measured FoundRuns::*member) {
  double sum = 0;
  double variance = 0;
  double scatter2 = 0;
  double count = 0;
  for (const FoundRuns* robot : robots) {
    const Measured& one = robot->*member;
    if (!std::isfinite(one.sigma) || !std::isfinite(one.value)) {
      continue;
    }
    sum += one.count * one.value;
    variance += one.count * one.count * one.sigma * one.sigma;
    scatter2 += one.count * one.scatter * one.scatter;
    count += one.count;
  }
  if (!(count > 0)) {
    return {kNan, kNan, kNan, 0};
  }
  return {sum / count, std::sqrt(variance) / count, std::sqrt(scatter2 / count), count};
}

Estimate normal(const char* name, const char* unit, double value, double sigma, double theory,
                double count, const char* note) {
  return {name,   unit,  value, sigma, value - kNormal95 * sigma, value + kNormal95 * sigma,
          theory, count, note};
}

/// A rate from counts. `relative` is the relative error of the time scale, which is that of the
/// speed.
Estimate rateEstimate(const char* name, double rate, double count, double relative, double theory,
                      const char* note) {
  const Interval interval = poissonInterval(count);
  const double low = std::hypot(1 - interval.low / count, kNormal95 * relative);
  const double high = std::hypot(interval.high / count - 1, kNormal95 * relative);
  return {name,
          "1/s",
          rate,
          rate * std::hypot(1 / std::sqrt(count), relative),
          rate * std::max(0.0, 1 - low),
          rate * (1 + high),
          theory,
          count,
          note};
}

/// The life table (Berkson and Gage 1950): the probability to end in each bar for runs that reach
/// it.
std::vector<DensityBar> runTimeBars(const std::vector<const FoundRuns*>& robots, double first,
                                    double rate, double hidden_share, double theory) {
  const double width = 1 / (kBarsPerMean * rate);
  std::vector<DensityBar> bars;
  // The share of runs longer than `first`.
  double survival = 1 - hidden_share;
  for (std::size_t i = 0; i < kMostBars; ++i) {
    DensityBar bar;
    bar.low = first + static_cast<double>(i) * width;
    bar.high = bar.low + width;
    double at_risk = 0;
    double cut_off = 0;
    for (const FoundRuns* robot : robots) {
      for (const ObservedRun& run : robot->runs) {
        at_risk += run.duration >= bar.low ? 1 : 0;
        const bool in = run.duration >= bar.low && run.duration < bar.high;
        bar.count += in && run.ended ? 1 : 0;
        cut_off += in && !run.ended ? 1 : 0;
      }
    }
    at_risk -= 0.5 * cut_off;
    // After the first bar with too few runs, survival is not known well enough.
    if (bar.count < kFewestPerBar || !(at_risk > 0)) {
      break;
    }
    const double chance = bar.count / at_risk;
    bar.density = survival * chance / width;
    bar.sigma = bar.density * std::sqrt((1 - survival * chance) / bar.count);
    bar.theory = (std::exp(-theory * bar.low) - std::exp(-theory * bar.high)) / width;
    bars.push_back(bar);
    survival *= 1 - chance;
  }
  return bars;
}

std::vector<DensityBar> turnBars(const std::vector<double>& turns) {
  const auto n = static_cast<double>(turns.size());
  const double count = std::min(kMostTurnBars, 4 * std::floor(n / kPerTurnBar / 4));
  std::vector<DensityBar> bars(static_cast<std::size_t>(std::max(0.0, count)));
  const double width = 2 * std::numbers::pi / count;
  for (const double turn : turns) {
    const double wrapped = wrapAngle(turn) + std::numbers::pi;
    const auto i = static_cast<std::size_t>(wrapped / width);
    if (!bars.empty()) {
      bars[std::min(i, bars.size() - 1)].count += 1;
    }
  }
  for (std::size_t i = 0; i < bars.size(); ++i) {
    DensityBar& bar = bars[i];
    bar.low = -std::numbers::pi + static_cast<double>(i) * width;
    bar.high = bar.low + width;
    bar.density = bar.count / (n * width);
    bar.sigma = std::sqrt(std::max(1.0, bar.count * (1 - bar.count / n))) / (n * width);
    bar.theory = 1 / (2 * std::numbers::pi);
  }
  return bars;
}

/// Adds D, L_s and the share of time in tumbles, with errors by linear propagation.
void addDerived(const ProgramLaw& law, const Measured& speed, const Measured& tumble, double rate,
                double rate_sigma, double run_time, RunStatistics& out) {
  const auto add = [&](const char* name, const char* unit, const char* note, auto function) {
    MeasuredMotion measured;
    measured.speed = speed.value;
    measured.run_end_rate = rate;
    measured.turn_time = tumble.value;
    const auto of = [&](const MeasuredMotion& motion) {
      return function(ExactLaw(law->measured(motion).value_or(law)));
    };
    const double value = of(measured);
    double variance = 0;
    const auto shift = [&](double MeasuredMotion::*quantity, double sigma) {
      if (!(sigma > 0)) {
        return;
      }
      MeasuredMotion other = measured;
      other.*quantity += sigma;
      const double change = of(other) - value;
      variance += change * change;
    };
    shift(&MeasuredMotion::speed, speed.sigma);
    shift(&MeasuredMotion::run_end_rate, rate_sigma);
    shift(&MeasuredMotion::turn_time, tumble.sigma);
    out.estimates.push_back(normal(name, unit, value, std::sqrt(variance), function(ExactLaw(law)),
                                   static_cast<double>(out.tumbles), note));
  };
  add("D", "m^2/s", "exact law at v, gamma and tau_t from poses",
      [](const ExactLaw& exact) { return exact.diffusivity(); });
  add("L_s", "m", "integral of C(l), exact law at v, gamma and tau_t from poses",
      [](const ExactLaw& exact) { return exact.persistenceLength(); });
  // The number of tumbles in a given time follows a renewal process.
  const double share = 1 - run_time / out.observed;
  const RunsAndTurns programmed = law->runs().value_or(RunsAndTurns{});
  const double product = programmed.rate * programmed.turn_time;
  const double cycles = out.observed * rate / std::pow(1 + rate * tumble.value, 3);
  out.estimates.push_back(normal("tumble_share", "", share,
                                 tumble.value * std::sqrt(cycles) / out.observed,
                                 product / (1 + product), static_cast<double>(out.tumbles),
                                 "time not in runs over the time; theory gamma tau_t / (1 + gamma "
                                 "tau_t)"));
}

void testRuns(const std::vector<const FoundRuns*>& robots, RunStatistics& out) {
  std::vector<WaitingTime> waiting;
  std::vector<double> before;
  std::vector<double> after;
  int track = 0;
  for (const FoundRuns* robot : robots) {
    const ObservedRun* last = nullptr;
    for (const ObservedRun& run : robot->runs) {
      waiting.push_back(
          {std::max(0.0, run.duration - robot->shortest), run.ended, track + run.track});
      if (run.follows && run.ended && last != nullptr && last->begun) {
        before.push_back(last->duration);
        after.push_back(run.duration);
      }
      last = &run;
    }
    track += static_cast<int>(robot->segments);
  }
  out.exponential = exponentialTest(waiting, kSeed);
  out.independent = correlationTest(before, after);
}

void testTurns(const ProgramLaw& law, const std::vector<const FoundRuns*>& robots, double tumble,
               RunStatistics& out) {
  std::vector<double> turns;
  double beyond = 0;
  for (const FoundRuns* robot : robots) {
    for (const ObservedRun& run : robot->runs) {
      if (std::isfinite(run.turn)) {
        constexpr double kClearly = 1.1;
        turns.push_back(run.turn);
        beyond += std::abs(run.turn) > kClearly * std::numbers::pi ? 1 : 0;
      }
    }
  }
  out.uniform = kuiperTest(turns);
  out.preferred = rayleighTest(turns);
  out.turns = turnBars(turns);
  out.needed_wheel_speed = std::numbers::pi / law->runs()->turn_time * law->wheelBase() / 2;
  out.wheel_speed = kNan;
  if (turns.empty()) {
    return;
  }
  out.beyond_half_turn = beyond / static_cast<double>(turns.size());
  for (double& turn : turns) {
    turn = std::abs(turn);
  }
  constexpr double kAlmostAll = 0.99;
  const auto rank = static_cast<std::ptrdiff_t>(kAlmostAll * static_cast<double>(turns.size()));
  std::nth_element(turns.begin(), turns.begin() + rank, turns.end());
  out.wheel_speed = turns[static_cast<std::size_t>(rank)] / tumble * law->wheelBase() / 2;
}

}  // namespace

const Estimate* RunStatistics::find(const std::string& name) const {
  const auto found = std::find_if(estimates.begin(), estimates.end(),
                                  [&](const Estimate& one) { return one.name == name; });
  return found == estimates.end() ? nullptr : &*found;
}

RunStatistics runStatistics(const ProgramLaw& law, const std::vector<const FoundRuns*>& all) {
  const RunsAndTurns programmed = law->runs().value_or(RunsAndTurns{});
  RunStatistics out;
  std::vector<const FoundRuns*> robots;
  Pool pool;
  for (const FoundRuns* robot : all) {
    if (!robot->resolved) {
      out.problem = programmed.speed > 0 ? "fewer than three frames in a tumble"
                                         : "a program whose runs stand still has none";
      continue;
    }
    robots.push_back(robot);
    out.observed += robot->observed;
    out.tumbles += robot->tumbles;
    out.hidden += robot->hidden;
    out.shortest = std::max(out.shortest, robot->shortest);
    for (const ObservedRun& run : robot->runs) {
      (run.ended ? out.runs : out.cut_off) += 1;
      pool.run_time += run.duration;
      pool.beyond += std::max(0.0, run.duration - robot->shortest);
    }
    pool.hidden.push_back({static_cast<double>(robot->hidden), robot->shortest});
  }
  const Measured speed = weighted(robots, &FoundRuns::speed);
  const Measured tumble = weighted(robots, &FoundRuns::tumble);
  pool.ended = static_cast<double>(out.runs);
  pool.hidden_count = static_cast<double>(out.hidden);
  constexpr double kFewest = 3;
  if (!(pool.ended >= kFewest) || !(speed.value > 0) || !(tumble.value > 0)) {
    if (out.problem.empty()) {
      out.problem = "fewer than three runs between tumbles were seen";
    }
    return out;
  }
  out.problem.clear();
  out.tumble_scatter = tumble.scatter;

  const double rate = pool.rate();
  const double relative = speed.sigma / speed.value;
  const double count = pool.ended + pool.hidden_count;
  const Estimate gamma =
      rateEstimate("gamma", rate, count, relative, programmed.rate,
                   "maximum likelihood of runs from poses: whole, cut off, and too short to see");
  out.estimates.push_back(gamma);
  out.estimates.push_back({"tau_r", "s", 1 / rate, gamma.sigma / (rate * rate), 1 / gamma.high95,
                           1 / gamma.low95, 1 / programmed.rate, count, "1 / gamma"});
  out.estimates.push_back(rateEstimate("gamma_truncated", pool.ended / pool.beyond, pool.ended,
                                       relative, programmed.rate,
                                       "the same without those too short to see (left-truncated)"));
  out.estimates.push_back(normal("tau_t", "s", tumble.value, tumble.sigma, programmed.turn_time,
                                 tumble.count,
                                 "mean time between the ends of the runs around single tumbles"));
  out.estimates.push_back(normal("v", "m/s", speed.value, speed.sigma, programmed.speed,
                                 speed.count, "slope of the way along runs"));
  const Measured turning = weighted(robots, &FoundRuns::turning_rate);
  if (turning.count > 0) {
    out.estimates.push_back(normal("omega", "rad/s", turning.value, turning.sigma, 0, turning.count,
                                   "angle between the halves of runs over time"));
  }
  double run_time = pool.run_time;
  for (const Pool::Hidden& one : pool.hidden) {
    run_time += one.count * one.shortest / 2;
  }
  addDerived(law, speed, tumble, rate, gamma.sigma, run_time, out);
  for (Estimate& one : out.estimates) {
    const bool timed = !one.unit.empty() && one.name != "v";
    if (timed) widenByClocks(one, static_cast<double>(robots.size()));
  }

  // Robots with a better resolution than others also have runs below the common first bar.
  double below = pool.hidden_count;
  for (const FoundRuns* robot : robots) {
    for (const ObservedRun& run : robot->runs) {
      below += run.duration < out.shortest && run.ended ? 1 : 0;
    }
  }
  out.run_times = runTimeBars(robots, out.shortest, rate, below / count, programmed.rate);
  testRuns(robots, out);
  testTurns(law, robots, tumble.value, out);
  return out;
}

}  // namespace lab::analysis
