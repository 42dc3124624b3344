#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <string_view>

#include "analyzer/analysis_feed.hpp"
#include "analyzer/bp_kurtosis.hpp"
#include "analyzer/observation.hpp"
#include "analyzer/phased_noise.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/math/units.hpp"
#include "runner/commands/commands.hpp"

namespace lab::runner {
namespace {

using analysis::ExactLaw;
using analysis::ProgramLaw;
using analysis::Turning;

constexpr double kCm2 = units::kCentimetre * units::kCentimetre;
constexpr double kShortestLag = 0.01;  // s, without --lags
constexpr double kLongestLag = 1000;
constexpr int kLagsPerDecade = 20;
constexpr std::array<std::string_view, 4> kModels = {"abp", "noisy_abp", "bp", "rtp"};

std::string without(std::string text, const std::string& part) {
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part)) {
    text.erase(at, part.size());
  }
  return text;
}

/// The program as an experiment file would have it: the same keys, ranges and messages. Wheels are
/// as fast as a file can make them: a law may be asked that the robots cannot execute.
Experiment experimentOf(const TheoryOptions& options) {
  const std::string& model = options.program;
  if (std::ranges::find(kModels, model) == kModels.end()) {
    throw UserError(
        fmt::format("theory: found program {}, allowed abp, noisy_abp, bp, rtp", model));
  }
  std::string text = fmt::format(
      "fileversion = 1\nname = \"theory\"\nduration_s = 1\nprogram = \"{0}\"\n"
      "[arena]\nwidth_cm = 1000\nheight_cm = 1000\n[robot]\nmax_wheel_speed_cm_s = 500\n"
      "sensor_period_ms = 1\n[[robots]]\nid = 1\n[programs.{0}]\nmodel = \"{0}\"\n",
      model);
  const std::string own = fmt::format("programs.{}.", model);
  const std::string hardware = "robot.";
  std::vector<std::string> set;
  for (const std::string& one : options.set) {
    const std::string key = one.substr(0, one.find('='));
    set.push_back((key == "diameter_cm" ? hardware : own) + one);
  }
  try {
    return parseExperiment(text, "theory", set);
  } catch (const ExperimentError& error) {
    std::string lines;
    for (const std::string& problem : error.problems()) {
      // "theory:13: " and "--set " are places that the user did not write.
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
    // The decimals of a short number: that is what the table says it is.
    const double lag = kShortestLag * std::pow(10, static_cast<double>(i) / kLagsPerDecade);
    lags.push_back(numberIn(fmt::format("{:.4g}", lag), "lag"));
  }
  return lags;
}

/// The range of turning angles [rad] that is asked for, the full circle by default.
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
  const auto refuse = [&options](const char* flag, const char* allowed) {
    throw UserError(
        fmt::format("theory: {}: found with {}, allowed {}", flag, options.program, allowed));
  };
  if (!options.turning_deg.empty() && law.kind != analysis::ProgramKind::kRtp) {
    refuse("--turning-deg", "with rtp");
  }
  if (options.kurtosis && law.kind != analysis::ProgramKind::kBp) refuse("--kurtosis", "with bp");
  if (locked && !analysis::isHeldNoise(law.kind)) {
    refuse("--phase-s, --phases", "with programs that hold their draws: abp, noisy_abp, bp");
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
  if (options.phase_s && (*options.phase_s < 0 || *options.phase_s > law.epsilon)) {
    throw UserError(fmt::format("theory: --phase-s: found {:g}, allowed 0 to epsilon_s = {:g}",
                                *options.phase_s, law.epsilon));
  }
}

/// The functions behind the columns, SI.
struct Columns {
  std::function<double(double)> msd;
  std::function<double(double)> angular_msd;
  std::function<double(double)> correlation;
};

Columns lockedColumns(const TheoryOptions& options, const ProgramLaw& law) {
  using analysis::HeldNoise;
  const double va = law.kind == analysis::ProgramKind::kBp ? 0 : law.va;
  const HeldNoise noise = law.kind == analysis::ProgramKind::kAbp
                              ? HeldNoise::uniformTurning(law.v, law.eta, law.epsilon)
                              : HeldNoise::uniformWheels(va, law.V, law.wheel_base, law.epsilon);
  const auto phased = std::make_shared<const analysis::PhasedNoise>(noise);
  const auto mean = [=, phases = options.phases.value_or(1),
                     first = options.phase_s.value_or(law.epsilon)](auto member) {
    return [=](double tau) {
      return analysis::commensurateMean(law.epsilon, phases, first, [&](double phase) {
        return ((*phased).*member)(tau, phase);
      });
    };
  };
  return {mean(&analysis::PhasedNoise::msd), mean(&analysis::PhasedNoise::angularMsd),
          mean(&analysis::PhasedNoise::velocityCorrelation)};
}

Columns columnsOf(const TheoryOptions& options, const ProgramLaw& law, const ExactLaw& exact) {
  const analysis::Observation seen{options.exposure_ms * 1e-3,
                                   options.noise_cm * units::kCentimetre,
                                   options.noise_deg * units::kDegree};
  Columns columns;
  if (options.phase_s || options.phases) {
    columns = lockedColumns(options, law);
  } else {
    columns.msd = [=](double tau) {
      return analysis::observedMsd(exact, {seen.exposure, 0, 0}, tau);
    };
    columns.angular_msd = [=](double tau) {
      return analysis::observedAngularMsd(exact, {seen.exposure, 0, 0}, tau);
    };
    columns.correlation = [=](double s) { return exact.velocityCorrelation(s); };
  }
  columns.msd = [=, msd = columns.msd](double tau) {
    return msd(tau) + 4 * seen.sigma * seen.sigma;
  };
  columns.angular_msd = [=, msd = columns.angular_msd](double tau) {
    return msd(tau) + 2 * seen.sigma_theta * seen.sigma_theta;
  };
  return columns;
}

void noteSaturation(const ProgramLaw& law, double largest_turn) {
  constexpr double kWheels = RobotHardware{}.max_wheel_speed;
  const double needed = analysis::neededWheelSpeed(law, largest_turn);
  if (needed <= kWheels) return;
  fmt::print(stderr,
             "note: this needs wheels of {:.3g} cm/s; wheels of {:.3g} cm/s (the default of "
             "robot.max_wheel_speed_cm_s) saturate, and their robot does not follow this law\n",
             needed / units::kCentimetre, kWheels / units::kCentimetre);
}

}  // namespace

ExitCode theory(const TheoryOptions& options) {
  const Experiment experiment = experimentOf(options);
  const ProgramLaw law =
      analysis::toLaw(toMessage(experiment.programs.begin()->second), experiment.hardware.diameter);
  checkFlags(options, law);
  const std::vector<double> lags = lagsOf(options.lags);
  const auto [low, high] = turningOf(options);
  const ExactLaw exact(law, options.turning_deg.empty() ? Turning{} : Turning::uniform(low, high));
  const Columns columns = columnsOf(options, law, exact);
  std::optional<analysis::BpKurtosis> kurtosis;
  if (options.kurtosis) kurtosis.emplace(law.V, law.wheel_base, law.epsilon);
  const double sigma = options.noise_cm * units::kCentimetre;
  noteSaturation(law, std::max(std::abs(low), std::abs(high)));

  std::string table = "tau_s,msd_cm2,amsd_rad2,cv_cm2_s2,msd_paper_cm2";
  table += kurtosis ? ",kurtosis\n" : "\n";
  for (const double tau : lags) {
    table += fmt::format("{:.15g},{:.15g},{:.15g},{:.15g},{:.15g}", tau, columns.msd(tau) / kCm2,
                         columns.angular_msd(tau), columns.correlation(tau) / kCm2,
                         analysis::paperMsd(law, tau) / kCm2);
    if (kurtosis) table += fmt::format(",{:.15g}", kurtosis->observed(tau, 4 * sigma * sigma));
    table += "\n";
  }
  fmt::print("{}", table);
  return kDone;
}

}  // namespace lab::runner
