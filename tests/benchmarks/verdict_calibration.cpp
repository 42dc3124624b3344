// Prints what p-values, verdicts and intervals are worth, over many simulated recordings of one
// program (the walker of the tests, which shares no code with the analyzer's simulation):
//
//   verdict_calibration abp|noisy_abp|bp|rtp RUNS [KEY=VALUE ...]
//
// Keys: duration (s), fps, robots, sigma (m), sigma_theta (rad), missing (share of lost frames),
// missing_length, clock, gain and base (standard deviations between robots of clocks, wheels and
// wheel base), step (of wheel speeds, m/s), nested (1: simulates the covariance anew for each run,
// as a report does), seed; a parameter of the program (v, epsilon, ...) sets what is programmed,
// and x_PARAMETER multiplies what the robots do instead.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "analyzer/fits/law_fit.hpp"
#include "analyzer/service/bootstrap_results.hpp"
#include "tests/analyzer/paper_programs.hpp"
#include "tests/analyzer/recording_ensemble.hpp"

namespace lab::analysis {
namespace {

/// The keys of the command line.
struct Keys {
  std::map<std::string, double> given;
  [[nodiscard]] double operator()(const std::string& key, double otherwise) const {
    const auto found = given.find(key);
    return found == given.end() ? otherwise : found->second;
  }
};

/// The largest distance of the distribution of p-values from a uniform one.
double kolmogorov(std::vector<double> values) {
  std::ranges::sort(values);
  const auto n = static_cast<double>(values.size());
  double distance = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto below = static_cast<double>(i);
    distance = std::max({distance, values[i] - below / n, (below + 1) / n - values[i]});
  }
  return distance;
}

void print(const char* what, const std::vector<double>& values) {
  if (values.empty()) return;
  const auto n = static_cast<double>(values.size());
  const auto below = [&](double p) {
    return std::count_if(values.begin(), values.end(), [p](double one) { return one < p; });
  };
  double sum = 0;
  for (const double value : values) sum += value;
  std::printf(
      "%-14s %5zu  mean %.3f  p<0.05 %4ld  p<0.01 %4ld  p<0.001 %4ld  KS %.3f (5 %%: %.3f)\n", what,
      values.size(), sum / n, static_cast<long>(below(0.05)), static_cast<long>(below(0.01)),
      static_cast<long>(below(0.001)), kolmogorov(values), 1.358 / std::sqrt(n));
}

struct Tally {
  std::vector<double> fit;
  std::vector<double> exact;
  std::vector<double> exact_msd;
  std::vector<double> paper;
  int agrees = 0;
  int deviates = 0;
  int undecided = 0;
  int beyond = 0;  ///< max |z| of 4 or more
  int misfit = 0;
  int rejected = 0;
  std::map<std::string, int> covered;
  std::map<std::string, Scatter> value;
  std::map<std::string, Scatter> sigma;
  std::map<std::string, double> theory;

  void cover(const std::string& kind, const std::vector<Estimate>& estimates) {
    for (const Estimate& one : estimates) {
      if (!std::isfinite(one.theory) || !std::isfinite(one.value)) continue;
      const std::string name = kind + " " + one.name;
      covered[name] += one.low95 <= one.theory && one.theory <= one.high95 ? 1 : 0;
      value[name].add(one.value / one.theory - 1);
      sigma[name].add(one.sigma / one.theory);
    }
  }

  void add(const ProgramResult& result) {
    switch (result.verdict.kind) {
      case VerdictKind::kAgrees:
        ++agrees;
        break;
      case VerdictKind::kDisagrees:
        ++deviates;
        break;
      case VerdictKind::kUndecided:
        ++undecided;
        break;
    }
    beyond += std::abs(result.verdict.max_z) >= 4 && result.verdict.judged >= 5 ? 1 : 0;
    misfit += result.verdict.misfit ? 1 : 0;
    rejected += result.verdict.rejected ? 1 : 0;
    cover("live", result.estimates);
    if (!result.fit || !result.fit->fitted()) return;
    cover("fit", result.fit->parameters);
    cover("fit", result.fit->derived);
    const auto push = [](std::vector<double>& to, double p) {
      if (std::isfinite(p)) to.push_back(p);
    };
    push(fit, result.fit->p_value);
    if (result.fit->exact) push(exact, result.fit->exact->p_value);
    if (result.fit->exact_msd) push(exact_msd, result.fit->exact_msd->p_value);
    if (result.fit->paper) push(paper, result.fit->paper->p_value);
  }

  void print() const {
    std::printf("agrees %d, deviates %d (max|z| >= 4: %d, misfit %d, rejected %d), undecided %d\n",
                agrees, deviates, beyond, misfit, rejected, undecided);
    analysis::print("goodness", fit);
    analysis::print("exact law", exact);
    analysis::print("exact, MSD", exact_msd);
    analysis::print("paper", paper);
    for (const auto& [name, count] : covered) {
      const Scatter& values = value.at(name);
      std::printf(
          "%-16s covered %5.1f %% of %g, bias %+.3f +- %.3f %%, sd %.3f %%, stated %.3f %%\n",
          name.c_str(), 100.0 * count / values.n, values.n, 100 * values.mean(),
          100 * values.deviation() / std::sqrt(values.n), 100 * values.deviation(),
          100 * sigma.at(name).mean());
    }
  }
};

ProgramLaw lawOfKeys(const std::string& name, const Keys& keys) {
  if (name == "abp") return abpLaw(keys("eta", 3), keys("epsilon", 0.5), keys("v", 0.03));
  if (name == "bp") return noisyLaw(0, keys("V", 0.07), keys("epsilon", 0.2));
  if (name == "noisy_abp") return noisyLaw(keys("va", 0.01), keys("V", 0.1), keys("epsilon", 0.1));
  if (name == "rtp") return rtpLaw(keys("gamma", 1), keys("tau_t", 0.5), keys("v", 0.05));
  std::fprintf(stderr, "found %s, expected abp, noisy_abp, bp or rtp\n", name.c_str());
  std::exit(2);
}

/// What one robot does: the program with its own clock and wheels.
ProgramLaw ofRobot(const ProgramLaw& programmed, const Keys& keys, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double second = 1 + keys("clock", 0) * normal(random);
  const double gain = 1 + keys("gain", 0) / std::sqrt(2.0) * normal(random);
  const double base = 1 + keys("base", 0) * normal(random);
  std::vector<std::pair<std::string, double>> values;
  for (const LawParameter& one : programmed->parameters()) {
    double value = one.value * keys("x_" + one.name, 1);
    if (one.unit == "s") value *= second;
    if (one.unit == "1/s") value /= second;
    if (one.unit == "m/s") value *= gain;
    if (one.unit == "rad/s") value *= gain / base;
    values.emplace_back(one.name, value);
  }
  return closedForm(programmed->name(), values, programmed->wheelBase() * base);
}

struct Runner {
  ProgramLaw law;
  Keys keys;
  std::mt19937_64 random;
  SimulatedCurves fit_recordings{};
  SimulatedCurves test_recordings{};

  BlockData record(std::uint64_t seed) {
    WalkerRecording recording;
    recording.law = ofRobot(law, keys, random);
    recording.duration = keys("duration", 600);
    recording.fps = keys("fps", 9.97);
    recording.telemetry_rate = recording.law->runs() ? 20 : 2;
    recording.sigma = keys("sigma", 0.0005);
    recording.sigma_theta = keys("sigma_theta", 0.0175);
    recording.missing = keys("missing", 0);
    recording.missing_length = keys("missing_length", 1);
    recording.cut_every = keys("cut_every", 0);
    recording.seed = seed;
    ProgramAnalysis analysis(law, 1 / recording.fps, keys("max_lag", 30));
    for (const Sample& sample : stitch(recording).samples) analysis.add(sample);
    return analysis.data();
  }

  /// As addBootstrapResults(), with covariances that are simulated once, at the programmed law.
  void completeShared(ProgramResult& result, const BlockData& data) {
    const MeasuredCurves curves_now = measuredCurves(law, data);
    const FitOptions options;
    if (fit_recordings.recordings == 0) {
      MeasuredCurves known = curves_now;
      known.offset = 4 * std::pow(keys("sigma", 0.0005), 2);
      known.angular_offset = 2 * std::pow(keys("sigma_theta", 0.0175), 2);
      fit_recordings = simulateForFit(law, known.offset, known.angular_offset, known,
                                      planFit(law, known, options), options);
      test_recordings = simulateForTest(law, known, 400, 40210);
    }
    result.fit = fitLaw(law, curves_now, options, &fit_recordings);
    CurveOptions curve_options;
    curve_options.recordings = &test_recordings;
    result.curves = curves(law, data, curve_options);
    if (result.fit->fitted()) {
      const auto test = [&](TestedLaw tested) {
        return testLaw(tested, law, curves_now, test_recordings, {});
      };
      result.fit->exact = test(TestedLaw::kExact);
      result.fit->exact_msd = test(TestedLaw::kExactMsd);
      result.fit->paper = test(TestedLaw::kPaper);
    }
    judgeMotion(result);
  }

  ProgramResult run(int number) {
    const int robots = static_cast<int>(keys("robots", 1));
    const auto seed = static_cast<std::uint64_t>(1'000'000 * keys("seed", 1));
    std::vector<BlockData> blocks;
    for (int robot = 0; robot < robots; ++robot) {
      blocks.push_back(record(seed + static_cast<std::uint64_t>(number * robots + robot)));
    }
    BlockData pool;
    std::vector<const BlockData*> data;
    std::vector<ProgramResult> each;
    for (const BlockData& own : blocks) {
      pool.pool(own);
      data.push_back(&own);
      if (keys("nested", 0) != 0) each.push_back(analyse(law, own, {}, {}));
    }
    ProgramResult result = analyse(law, pool, {}, {});
    if (keys("nested", 0) != 0) {
      addBootstrapResults(result, pool, each, data, {});
    } else {
      completeShared(result, pool);
    }
    return result;
  }
};

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "verdict_calibration PROGRAM RUNS [KEY=VALUE ...]\n");
    return 2;
  }
  Keys keys;
  for (int i = 3; i < argc; ++i) {
    const std::string text = argv[i];
    const std::size_t at = text.find('=');
    if (at == std::string::npos) {
      std::fprintf(stderr, "found %s, expected KEY=VALUE\n", text.c_str());
      return 2;
    }
    keys.given[text.substr(0, at)] = std::atof(text.c_str() + at + 1);
  }
  Runner runner{lawOfKeys(argv[1], keys), keys,
                std::mt19937_64(static_cast<unsigned>(keys("seed", 1)))};
  Tally tally;
  for (int i = 0; i < std::atoi(argv[2]); ++i) tally.add(runner.run(i));
  tally.print();
  return 0;
}

}  // namespace
}  // namespace lab::analysis

int main(int argc, char** argv) { return lab::analysis::main(argc, argv); }
