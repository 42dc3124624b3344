#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/analysis_feed.hpp"
#include "analyzer/laws.hpp"
#include "analyzer/theory_table.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/files/file_values.hpp"
#include "common/math/units.hpp"
#include "runner/analyze/analyze_commands.hpp"

namespace lab::runner {
namespace {

using analysis::Law;
using analysis::ProgramLaw;
using analysis::Turning;

constexpr double kCm2 = units::kCentimetre * units::kCentimetre;
constexpr double kShortestLag = 0.01;  // s, without --lags
constexpr double kLongestLag = 1000;
constexpr int kLagsPerDecade = 20;

std::string without(std::string text, const std::string& part) {
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part)) {
    text.erase(at, part.size());
  }
  return text;
}

/// Reads the program as from an experiment file in the working directory, so with the same keys,
/// ranges and errors; a program file is found from there. The wheels get the highest speed that a
/// file may have: laws are also computed for programs that real robots cannot execute.
Experiment experimentOf(const TheoryOptions& options) {
  const std::string& model = options.program;
  const std::string text = fmt::format(
      "fileversion = 1\nname = \"theory\"\nduration_s = 1\nprogram = \"motion\"\n"
      "[arena]\nwidth_cm = 1000\nheight_cm = 1000\n[robot]\nmax_wheel_speed_cm_s = 500\n"
      "sensor_period_ms = 1\n[[robots]]\nid = 1\n[programs.motion]\nmodel = {}\n",
      keys::tomlString(model));
  const std::string own = "programs.motion.";
  const std::string hardware = "robot.";
  std::vector<std::string> set;
  for (const std::string& one : options.set) {
    const std::string key = one.substr(0, one.find('='));
    set.push_back((key == "diameter_cm" ? hardware : own) + one);
  }
  try {
    return parseExperiment(text, "theory", set, std::filesystem::current_path());
  } catch (const ExperimentError& error) {
    std::string lines;
    for (const std::string& problem : error.problems()) {
      // The user wrote neither "theory:13: " nor "--set ".
      std::string line = without(without(without(problem, "--set "), own), hardware);
      if (line.rfind("theory:", 0) == 0) line.erase(0, line.find(": ") + 2);
      lines += (lines.empty() ? "" : "\n") + fmt::format("theory {}: {}", model, line);
    }
    throw ExperimentError({lines});
  }
}

double numberIn(std::string_view text, const char* option) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size() && std::isfinite(value))
    return value;
  throw UserError(
      fmt::format("theory: {}: found \"{}\", allowed numbers, separated by commas", option, text));
}

std::vector<double> numberList(const std::string& list, const char* option) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    numbers.push_back(numberIn(std::string_view(list).substr(begin, end - begin), option));
    begin = end + 1;
  }
  return numbers;
}

std::vector<double> lagsOf(const std::string& list) {
  if (!list.empty()) {
    std::vector<double> lags = numberList(list, "--lags");
    for (const double lag : lags) {
      if (lag > 0 && lag <= 1e6) continue;
      throw UserError(fmt::format("theory: --lags: found {:g}, allowed above 0 to 1000000 s", lag));
    }
    return lags;
  }
  std::vector<double> lags;
  const int count =
      static_cast<int>(std::lround(kLagsPerDecade * std::log10(kLongestLag / kShortestLag)));
  for (int i = 0; i <= count; ++i) {
    // Rounded to the digits that the table prints, so that the row belongs to exactly this lag.
    const double lag = kShortestLag * std::pow(10, static_cast<double>(i) / kLagsPerDecade);
    lags.push_back(numberIn(fmt::format("{:.4g}", lag), "lag"));
  }
  return lags;
}

/// The range of turning angles [rad] on the command line, by default the full circle.
std::pair<double, double> turningOf(const TheoryOptions& options) {
  if (options.turning_deg.empty()) return {-std::numbers::pi, std::numbers::pi};
  const std::vector<double> ends = numberList(options.turning_deg, "--turning-deg");
  if (ends.size() != 2 || ends[0] > ends[1] || std::abs(ends[0]) > 3600 ||
      std::abs(ends[1]) > 3600) {
    throw UserError(
        fmt::format("theory: --turning-deg: found \"{}\", allowed LOW,HIGH with -3600 <= "
                    "LOW <= HIGH <= 3600",
                    options.turning_deg));
  }
  return {ends[0] * units::kDegree, ends[1] * units::kDegree};
}

void checkFlags(const TheoryOptions& options, const ProgramLaw& law) {
  const bool locked = options.phase_s.has_value() || options.phases.has_value();
  const auto refuse = [&options](const char* flag, const std::string& allowed) {
    throw UserError(
        fmt::format("theory: {}: found with {}, allowed {}", flag, options.program, allowed));
  };
  if (!options.turning_deg.empty() && !law->runs()) {
    refuse("--turning-deg", "with " + analysis::closedFormsWith(
                                          [](const Law& one) { return one.runs().has_value(); }));
  }
  if (options.kurtosis && !law->kurtosis()) {
    refuse("--kurtosis", "with " + analysis::closedFormsWith(
                                       [](const Law& one) { return one.kurtosis() != nullptr; }));
  }
  if (locked && !law->held()) {
    refuse("--phase-s, --phases",
           "with programs that hold their draws: " +
               analysis::closedFormsWith([](const Law& one) { return one.held().has_value(); }));
  }
  if (options.kurtosis && options.exposure_ms > 0) {
    throw UserError(
        "theory: --kurtosis: found with --exposure-ms, allowed without: it is of instants");
  }
  if (locked && (options.exposure_ms > 0 || options.kurtosis)) {
    throw UserError(
        "theory: --phase-s, --phases: found with --exposure-ms or --kurtosis, allowed without: "
        "these "
        "are of a random phase");
  }
  // Written so that nan is refused too.
  if (options.phase_s && !(*options.phase_s >= 0 && *options.phase_s <= law->drawTime())) {
    throw UserError(fmt::format("theory: --phase-s: found {:g}, allowed 0 to epsilon_s = {:g}",
                                *options.phase_s, law->drawTime()));
  }
}

void noteSaturation(const ProgramLaw& law, double largest_turn) {
  const double wheels = RobotHardware{}.max_wheel_speed;
  const double needed = law->neededWheelSpeed(largest_turn);
  if (!(needed > wheels)) return;
  fmt::print(stderr,
             "note: this needs wheels of {:.3g} cm/s; wheels of {:.3g} cm/s (the default of "
             "robot.max_wheel_speed_cm_s) saturate, and their robot does not follow this law\n",
             needed / units::kCentimetre, wheels / units::kCentimetre);
}

}  // namespace

ExitCode theory(const TheoryOptions& options) {
  const Experiment experiment = experimentOf(options);
  const ProgramLaw law =
      analysis::lawOf(experiment.programs.begin()->second, experiment.hardware.diameter);
  if (!analysis::ExactLaw(law).exists()) {
    throw UserError(fmt::format(
        "theory: found program {}, allowed programs with a law in closed form ({}) or with "
        "formulas "
        "of their own. {}",
        options.program, analysis::closedFormsWith([](const Law&) { return true; }),
        law->isSimulated() ? "Reports compare it with simulated films." : law->whyNoVerdict()));
  }
  checkFlags(options, law);
  const std::vector<double> lags = lagsOf(options.lags);
  const auto [low, high] = turningOf(options);
  analysis::TheoryConditions conditions;
  conditions.exposure = options.exposure_ms * 1e-3;
  conditions.sigma = options.noise_cm * units::kCentimetre;
  conditions.sigma_theta = options.noise_deg * units::kDegree;
  if (!options.turning_deg.empty()) conditions.turning = Turning::uniform(low, high);
  conditions.phases = options.phases;
  conditions.phase = options.phase_s;
  const analysis::TheoryColumns columns = analysis::theoryColumns(law, conditions);
  noteSaturation(law, std::max(std::abs(low), std::abs(high)));

  std::string table = "tau_s,msd_cm2,amsd_rad2,cv_cm2_s2,msd_paper_cm2";
  table += options.kurtosis ? ",kurtosis\n" : "\n";
  for (const double tau : lags) {
    table += fmt::format("{:.15g},{:.15g},{:.15g},{:.15g},{:.15g}", tau, columns.msd(tau) / kCm2,
                         columns.angular_msd(tau), columns.correlation(tau) / kCm2,
                         law->paperMsd(tau) / kCm2);
    if (options.kurtosis) table += fmt::format(",{:.15g}", columns.kurtosis(tau));
    table += "\n";
  }
  fmt::print("{}", table);
  return kDone;
}

}  // namespace lab::runner
