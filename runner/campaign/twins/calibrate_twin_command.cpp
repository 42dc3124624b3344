#include "runner/campaign/twins/calibrate_twin_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/files/atomic_file.hpp"
#include "common/text/format.hpp"
#include "common/text/printable.hpp"
#include "runner/campaign/axis.hpp"
#include "runner/campaign/campaign_data.hpp"
#include "runner/campaign/twins/twin_comparison.hpp"
#include "runner/campaign/twins/twin_page.hpp"
#include "runner/campaign/twins/twin_regression.hpp"
#include "runner/campaign/twins/twin_simulation.hpp"
#include "runner/command_line/command_line_parts.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

constexpr int kFewestDrawn = 40;      // twins of a round
constexpr double kRangeErrors = 5;    // half width of a narrowed range, in standard errors
constexpr double kLeastRange = 0.05;  // narrowed range, relative to the one before
constexpr double kUnknown = 0.2;      // a parameter of which the looks predict less is not known

/// A parameter as it is fitted: the logarithm if its range is logarithmic.
struct Parameter {
  Axis axis;
  double low = 0;  ///< of the range in which it is drawn now
  double high = 0;

  [[nodiscard]] bool isLog() const { return axis.range->logarithmic; }
  [[nodiscard]] double inFit(double value) const { return isLog() ? std::log(value) : value; }
  [[nodiscard]] double outOfFit(double value) const { return isLog() ? std::exp(value) : value; }
  [[nodiscard]] std::string over() const {
    return fmt::format("{}={:.9g}:{:.9g}{}", axis.key, low, high, isLog() ? ":log" : "");
  }
};

/// A parameter with its interval.
struct Fitted {
  std::string key;
  double value = 0;
  double sigma = 0;
  double low95 = 0;
  double high95 = 0;
  double known = 0;
  bool at_edge = false;  ///< the interval reaches beyond the range that was given

  [[nodiscard]] bool isKnown() const { return known >= kUnknown && std::isfinite(value); }
};

std::vector<Parameter> parametersOf(const CalibrateTwinOptions& options) {
  std::vector<Parameter> parameters;
  for (Axis& axis : parseAxes(options.fit, "--fit")) {
    if (!axis.range || !axis.values.empty()) {
      throw UserError(fmt::format(
          "--fit {}: found values, expected a range KEY=LOW:HIGH in which the parameter is sought",
          axis.key));
    }
    if (axis.key.find('[') != std::string::npos) {
      throw UserError(
          fmt::format("--fit {}: found a part of a list, expected a key of a table", axis.key));
    }
    const double low = axis.range->low;
    const double high = axis.range->high;
    parameters.push_back({std::move(axis), low, high});
  }
  return parameters;
}

std::string nameOf(const fs::path& run) {
  const fs::path path = fs::absolute(run).lexically_normal();
  return (path.has_filename() ? path.filename() : path.parent_path().filename()).string();
}

/// The parameters of one run by one round of twins.
std::optional<TwinEstimates> estimatesOf(const TwinOrigin& origin,
                                         const std::vector<Parameter>& parameters,
                                         const fs::path& folder,
                                         const CalibrateTwinOptions& options) {
  TwinPlan plan{.folder = folder, .count = options.count};
  for (const Parameter& parameter : parameters) plan.over.push_back(parameter.over());
  const TwinSummaries twins = simulateTwins(origin, plan, options.jobs);
  if (twins.interrupted) return std::nullopt;
  if (twins.summaries.size() < static_cast<std::size_t>(kFewestDrawn)) {
    throw UserError(fmt::format("{}: only {} twins have a result, expected at least {}: {}",
                                origin.run.string(), twins.summaries.size(), kFewestDrawn,
                                twins.reason));
  }
  std::vector<std::vector<double>> drawn;
  for (const PointValues& values : twins.values) {
    std::vector<double>& one = drawn.emplace_back();
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      one.push_back(parameters[k].inFit(numberIn(values[k]).value()));
    }
  }
  return estimateParameters(looksOf(origin.facts.summary, twins.summaries), drawn);
}

std::vector<Fitted> fittedOf(const TwinEstimates& estimates,
                             const std::vector<Parameter>& parameters) {
  std::vector<Fitted> list;
  const boost::math::students_t student(std::max(1.0, estimates.freedom));
  const double quantile = boost::math::quantile(student, 0.975);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const Parameter& parameter = parameters[k];
    const double at = estimates.values[k];
    const double half = quantile * estimates.sigmas[k];
    Fitted fitted{.key = parameter.axis.key,
                  .value = parameter.outOfFit(at),
                  .sigma = estimates.sigmas[k],
                  .low95 = parameter.outOfFit(at - half),
                  .high95 = parameter.outOfFit(at + half),
                  .known = estimates.known[k]};
    if (parameter.isLog()) fitted.sigma *= fitted.value;
    const DrawnRange& given = *parameter.axis.range;
    fitted.at_edge = fitted.low95 < given.low || fitted.high95 > given.high;
    list.push_back(std::move(fitted));
  }
  return list;
}

/// Draws the next round around the estimates.
void narrow(const TwinEstimates& estimates, std::vector<Parameter>& parameters) {
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    Parameter& parameter = parameters[k];
    if (estimates.known[k] < kUnknown || !std::isfinite(estimates.values[k])) continue;
    const double low = parameter.inFit(parameter.low);
    const double high = parameter.inFit(parameter.high);
    const double half =
        std::max(kRangeErrors * estimates.sigmas[k], 0.5 * kLeastRange * (high - low));
    const double centre = std::clamp(estimates.values[k], low, high);
    parameter.low = std::max(parameter.low, parameter.outOfFit(centre - half));
    parameter.high = std::min(parameter.high, parameter.outOfFit(centre + half));
  }
}

void printFitted(const std::vector<Fitted>& list) {
  for (const Fitted& one : list) {
    if (!one.isKnown()) {
      fmt::print("  {:<36} not determined: what was measured predicts {:.0f} % of it\n", one.key,
                 100 * std::max(0.0, one.known));
      continue;
    }
    fmt::print("  {:<36} {} +- {} (95 %: {} to {}){}\n", one.key, shortText(one.value),
               shortText(one.sigma), shortText(one.low95), shortText(one.high95),
               one.at_edge ? ", beyond the range of --fit" : "");
  }
}

/// Keys for an experiment file.
std::string fittedToml(const std::vector<Fitted>& list, const CalibrateTwinOptions& options) {
  std::string text = "# By lab calibrate twin from";
  for (const fs::path& run : options.runs) text += " " + printable(nameOf(run));
  text += ". Keys of an experiment file; as options: --set KEY=VALUE.\n";
  for (const Fitted& one : list) {
    text += one.isKnown() ? fmt::format("{} = {:.6g}  # +- {:.2g}; 95 %: {:.6g} to {:.6g}\n",
                                        one.key, one.value, one.sigma, one.low95, one.high95)
                          : fmt::format("# {}: not determined\n", one.key);
  }
  return text;
}

struct Compared {
  std::string run;
  bool held_out = false;
  TwinReport report;
};

std::string fittedJson(const std::vector<Fitted>& list, const CalibrateTwinOptions& options,
                       double p, const std::vector<Compared>& compared) {
  nlohmann::ordered_json json;
  json["version"] = thisCode().text;
  for (const fs::path& run : options.runs) json["runs"].push_back(nameOf(run));
  for (const Fitted& one : list) {
    json["parameters"].push_back({{"key", one.key},
                                  {"determined", one.isKnown()},
                                  {"value", one.value},
                                  {"standard_error", one.sigma},
                                  {"low95", one.low95},
                                  {"high95", one.high95},
                                  {"share_predicted", one.known}});
  }
  json["p_of_differences_between_runs"] = p;
  for (const Compared& one : compared) {
    json["compared"].push_back({{"run", one.run},
                                {"held_out", one.held_out},
                                {"p_all_looks", one.report.comparison.p},
                                {"agrees", one.report.comparison.p >= kDeviates}});
  }
  return json.dump(1) + "\n";
}

/// Compares a run with twins that have the fitted parameters.
std::optional<Compared> compareFitted(const TwinOrigin& origin, bool held_out,
                                      const std::vector<Fitted>& list, const fs::path& folder,
                                      const CalibrateTwinOptions& options) {
  TwinPlan plan{.folder = folder, .count = options.compared};
  for (const Fitted& one : list) {
    if (one.isKnown()) plan.set.push_back(fmt::format("{}={:.9g}", one.key, one.value));
  }
  const TwinSummaries twins = simulateTwins(origin, plan, options.jobs);
  if (twins.interrupted) return std::nullopt;
  if (twins.summaries.size() < static_cast<std::size_t>(kFewestTwins)) {
    throw UserError(fmt::format("{}: only {} twins with the fitted parameters have a result: {}",
                                origin.run.string(), twins.summaries.size(), twins.reason));
  }
  return Compared{
      nameOf(origin.run),
      held_out,
      {nameOf(origin.run), thisCode().text,
       compareWithTwins(looksOf(origin.facts.summary, twins.summaries)), origin.twins.remarks}};
}

ExitCode interrupted() {
  fmt::print("stopped  by the user; what is done stays, and the same command continues\n");
  return kFailed;
}

}  // namespace

ExitCode calibrateTwin(const CalibrateTwinOptions& options) {
  std::vector<Parameter> parameters = parametersOf(options);
  std::vector<TwinOrigin> origins;
  for (const fs::path& run : options.runs) origins.push_back(readTwinOrigin(run));
  std::optional<TwinOrigin> held_out;
  if (options.held_out) held_out = readTwinOrigin(*options.held_out);
  const fs::path out = fs::absolute(options.out).lexically_normal();

  PooledEstimates pooled;
  for (int round = 1; round <= options.rounds; ++round) {
    if (round > 1) narrow(pooled.estimates, parameters);
    std::vector<TwinEstimates> estimates;
    for (std::size_t i = 0; i < origins.size(); ++i) {
      const fs::path folder = out / fmt::format("run-{}-round-{}", i + 1, round);
      auto of_run = estimatesOf(origins[i], parameters, folder, options);
      if (!of_run) return interrupted();
      estimates.push_back(std::move(*of_run));
    }
    pooled = poolEstimates(estimates);
    fmt::print("round {}  {} twins of each of {} runs\n", round, options.count, origins.size());
    printFitted(fittedOf(pooled.estimates, parameters));
    std::fflush(stdout);
  }
  const std::vector<Fitted> fitted = fittedOf(pooled.estimates, parameters);

  std::vector<Compared> compared;
  const auto compare = [&](const TwinOrigin& origin, bool is_held_out, const std::string& folder) {
    auto one = compareFitted(origin, is_held_out, fitted, out / folder, options);
    if (one) compared.push_back(std::move(*one));
    return one.has_value();
  };
  if (held_out && !compare(*held_out, true, "held-out")) return interrupted();
  for (std::size_t i = 0; i < origins.size() && !held_out; ++i) {
    if (!compare(origins[i], false, fmt::format("run-{}-fitted", i + 1))) return interrupted();
  }
  replaceFile(out / "fitted.toml", fittedToml(fitted, options));
  replaceFile(out / "fitted.json", fittedJson(fitted, options, pooled.p, compared));
  if (origins.size() > 1) {
    fmt::print("runs     differ in the parameters with p = {:.2g}\n", pooled.p);
  }
  for (const Compared& one : compared) {
    fmt::print("{} {} {}\n", one.held_out ? "held out" : "result  ", printable(one.run),
               printable(verdictOf(one.report)));
  }
  fmt::print("keys     {}\n", printable((out / "fitted.toml").string()));
  return kDone;
}

void addCalibrateTwin(CLI::App& calibrate, Chosen& chosen) {
  auto options = std::make_shared<CalibrateTwinOptions>();
  CLI::App* command = calibrate.add_subcommand(
      "twin", "Parameters of the simulation, as noise, friction or errors of wheels, from runs");
  command->add_option("RUN", options->runs, "Folders of runs, or logs")->required();
  command
      ->add_option("--fit", options->fit,
                   "KEY=LOW:HIGH, also :log: a key of the experiment, and the range in which its "
                   "value is sought (repeatable)")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--held-out", options->held_out,
                      "A run that is compared with twins at the result, and not fitted");
  command->add_option("--out", options->out, "Folder for the results")
      ->capture_default_str()
      ->check(folderOrNewName());
  command->add_option("--count", options->count, "Twins of each run in each round")
      ->check(CLI::Range(kFewestDrawn, 100000))
      ->capture_default_str();
  command->add_option("--rounds", options->rounds, "Rounds; each draws in narrower ranges")
      ->check(CLI::Range(1, 5))
      ->capture_default_str();
  command->add_option("--jobs", options->jobs, "Twins at a time (default: one per core)")
      ->check(CLI::Range(1, 10000));
  command->callback([&chosen, options] { chosen = [options] { return calibrateTwin(*options); }; });
}

}  // namespace lab::runner::campaign
