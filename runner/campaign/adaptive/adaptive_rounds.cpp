#include "runner/campaign/adaptive/adaptive_rounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "common/math/units.hpp"
#include "common/text/format.hpp"
#include "common/text/json_text.hpp"
#include "runner/campaign/adaptive/adaptive_goal.hpp"

namespace lab::runner::campaign {
namespace {

using Json = nlohmann::ordered_json;
using Kind = RowState::Kind;

constexpr std::size_t kStartBeyondKeys = 3;  // places of the start, more than there are keys
constexpr std::size_t kListedPlaces = 4;

bool wasTried(const RowState& state) {
  return state.kind == Kind::kDone || state.kind == Kind::kStale || state.kind == Kind::kFailed;
}

/// The rows of each point that may still be run, in the order of their seeds.
std::vector<std::vector<std::size_t>> rowsLeft(const CampaignData& data) {
  std::vector<std::vector<std::size_t>> left(data.points.size());
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (!wasTried(data.survey.rows[i])) left[data.rows[i].point].push_back(i);
  }
  return left;
}

std::string placeText(const CampaignData& data, const std::vector<std::string>& values) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string& key = data.axes[i].key;
    text += fmt::format("{}{}={}", i == 0 ? "" : ", ", key.substr(key.rfind('.') + 1), values[i]);
  }
  return text;
}

std::set<std::vector<double>> measuredPlaces(const CampaignGoal& goal,
                                             const std::vector<RunValue>& runs) {
  std::set<std::vector<double>> places;
  for (const RunValue& run : runs) places.insert(goal.candidates[run.candidate].keys);
  return places;
}

/// New places that the start still needs.
std::size_t placesMissing(const CampaignGoal& goal, const std::vector<RunValue>& runs) {
  const std::size_t wanted = std::min(goal.candidates.front().keys.size() + kStartBeyondKeys,
                                      distinctPlaces(goal.candidates).size());
  const std::size_t measured = measuredPlaces(goal, runs).size();
  return wanted > measured ? wanted - measured : 0;
}

/// Runs of the start: one at each new place, in the order in which a process without a law asks.
/// They are spread over the keys also for a law, so that a deviation from it shows.
std::vector<ChosenRun> chooseStart(const CampaignGoal& goal, const std::vector<RunValue>& runs,
                                   Choices choices) {
  GaussianDesign design = goal.spread(runs);
  std::set<std::vector<double>> seen = measuredPlaces(goal, runs);
  const std::size_t count = std::min(choices.count, placesMissing(goal, runs));
  choices.count = 1;
  std::vector<ChosenRun> chosen;
  while (chosen.size() < count) {
    for (std::size_t i = 0; i < choices.left.size(); ++i) {
      if (seen.contains(goal.candidates[i].keys)) choices.left[i] = 0;
    }
    const std::vector<ChosenRun> next = chooseRuns(design, choices);
    if (next.empty()) break;
    const std::size_t candidate = next.front().candidate;
    chosen.push_back(next.front());
    seen.insert(goal.candidates[candidate].keys);
    choices.time_left -= choices.costs[candidate];
  }
  return chosen;
}

/// The runs of a round; `design` is that after them.
std::vector<ChosenRun> chooseRound(const CampaignGoal& goal, const std::vector<RunValue>& runs,
                                   GaussianDesign& design, Choices choices) {
  std::vector<ChosenRun> chosen = chooseStart(goal, runs, choices);
  for (ChosenRun& one : chosen) {
    const double before = design.variance();
    condition(design, static_cast<Eigen::Index>(one.candidate));
    one.reduction = before - design.variance();
    --choices.left[one.candidate];
    choices.time_left -= choices.costs[one.candidate];
  }
  choices.count -= chosen.size();
  const std::vector<ChosenRun> others = chooseRuns(design, std::move(choices));
  chosen.insert(chosen.end(), others.begin(), others.end());
  return chosen;
}

std::string endOf(const AdaptivePlan& plan, bool any_left, bool any_fits) {
  if (!any_left) return "all runs of the grid are made";
  if (any_fits) return {};
  return fmt::format("the robot time of {} is spent", durationText(plan.robot_time_s));
}

}  // namespace

AdaptiveRound nextRound(const CampaignData& data, std::int64_t number) {
  const AdaptivePlan& plan = data.request.adaptive.value();
  const CampaignGoal goal = goalOf(data.request, data.points);
  const std::vector<RunValue> runs = valuesOf(data);
  GoalState state = goal.state(runs);

  AdaptiveRound round;
  round.number = number;
  round.error = state.error;
  const std::vector<std::vector<std::size_t>> left = rowsLeft(data);
  Choices choices;
  choices.count = static_cast<std::size_t>(plan.runs_per_round);
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (wasTried(data.survey.rows[i])) round.robot_time_s += goal.costs[data.rows[i].point];
  }
  choices.time_left = plan.robot_time_s > 0 ? plan.robot_time_s - round.robot_time_s
                                            : std::numeric_limits<double>::infinity();
  bool any_left = false;
  bool any_fits = false;
  for (std::size_t i = 0; i < left.size(); ++i) {
    choices.costs.push_back(goal.costs[i]);
    choices.left.push_back(static_cast<std::int64_t>(left[i].size()));
    any_left = any_left || !left[i].empty();
    any_fits = any_fits || (!left[i].empty() && goal.costs[i] <= choices.time_left);
  }
  if (plan.error > 0 && round.error <= plan.error && placesMissing(goal, runs) == 0) {
    round.end = fmt::format("the error is at most {}", errorText(plan, plan.error));
    return round;
  }
  round.end = endOf(plan, any_left, any_fits);
  if (!round.end.empty()) return round;

  const std::vector<ChosenRun> chosen = chooseRound(goal, runs, state.design, choices);
  std::vector<std::size_t> used(data.points.size());
  for (const ChosenRun& one : chosen) {
    const std::size_t row = left[one.candidate][used[one.candidate]++];
    round.runs.push_back({data.rows[row].identity.recipe, row, data.points[one.candidate].values,
                          goal.costs[one.candidate], one.reduction});
  }
  round.expected_error = std::sqrt(std::max(0.0, state.design.variance()));
  return round;
}

GoalState goalState(const CampaignData& data) {
  return goalOf(data.request, data.points).state(valuesOf(data));
}

std::string placesText(const CampaignData& data, const AdaptiveRound& round) {
  std::vector<std::pair<std::vector<std::string>, int>> places;
  for (const PlannedRun& run : round.runs) {
    const auto known = std::ranges::find(places, run.values, [](const auto& p) { return p.first; });
    if (known == places.end()) {
      places.emplace_back(run.values, 1);
    } else {
      ++known->second;
    }
  }
  std::string text;
  for (std::size_t i = 0; i < std::min(places.size(), kListedPlaces); ++i) {
    text += fmt::format("{}{}{}", i == 0 ? "" : "; ", placeText(data, places[i].first),
                        places[i].second > 1 ? fmt::format(" ({} runs)", places[i].second) : "");
  }
  if (places.size() > kListedPlaces) {
    text += fmt::format("; {} more points", places.size() - kListedPlaces);
  }
  return text;
}

std::string roundText(const CampaignData& data, const AdaptiveRound& round) {
  const AdaptivePlan& plan = data.request.adaptive.value();
  const std::string error =
      std::isfinite(round.error) ? "error " + errorText(plan, round.error) + ", " : "";
  return fmt::format(
      "round {:<3}{}: {}{} expected after {}", round.number, placesText(data, round), error,
      errorText(plan, round.expected_error),
      durationText(std::accumulate(
          round.runs.begin(), round.runs.end(), round.robot_time_s,
          [](double sum, const PlannedRun& run) { return sum + run.robot_time_s; })));
}

std::string goalText(const AdaptivePlan& plan) {
  if (plan.goal == AdaptiveGoal::kMean) return plan.quantity + " at all points";
  if (plan.goal == AdaptiveGoal::kBoundary) {
    return fmt::format("boundary {} = {}", plan.quantity, plan.level);
  }
  if (plan.parameter == "prefactor" || plan.parameter == "curve") {
    return fmt::format("{} of the power law of {}", plan.parameter, plan.quantity);
  }
  return fmt::format("{} of the power law of {}",
                     plan.parameter.empty() || plan.parameter == "exponents"
                         ? "exponents"
                         : "exponent of " + plan.parameter,
                     plan.quantity);
}

std::string errorText(const AdaptivePlan& plan, double error) {
  if (!std::isfinite(error)) return "unknown";
  const bool relative = plan.relative || plan.goal == AdaptiveGoal::kBoundary ||
                        plan.parameter == "prefactor" || plan.parameter == "curve";
  return relative ? fmt::format("{:.3g} %", error * units::kPercents)
                  : fmt::format("{:.3g}", error);
}

std::string roundLine(const AdaptiveRound& round) {
  Json runs = Json::array();
  for (const PlannedRun& run : round.runs) {
    runs.push_back({{"run", run.recipe},
                    {"row", run.row},
                    {"values", run.values},
                    {"robot_time_s", run.robot_time_s},
                    {"variance_reduction", run.reduction}});
  }
  return Json{{"round", round.number},
              {"robot_time_s", round.robot_time_s},
              {"error", std::isfinite(round.error) ? Json(round.error) : Json()},
              {"expected_error", round.expected_error},
              {"runs", std::move(runs)}}
             .dump(-1, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

std::vector<AdaptiveRound> readRounds(std::string_view text, std::size_t axes) {
  std::vector<AdaptiveRound> rounds;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const Json json = parseJsonText<Json>(text.substr(begin, end - begin));
    begin = end + 1;
    try {
      AdaptiveRound round;
      round.number = wholeNumber<decltype(round.number)>(json.at("round"), 0, kMostRows);
      round.robot_time_s = json.at("robot_time_s");
      round.error = json.at("error").is_null() ? std::numeric_limits<double>::infinity()
                                               : json.at("error").get<double>();
      round.expected_error = json.at("expected_error");
      for (const Json& run : json.at("runs")) {
        round.runs.push_back({run.at("run"), wholeNumber<std::size_t>(run.at("row"), 0, kMostRows),
                              run.at("values"), run.at("robot_time_s"),
                              run.at("variance_reduction")});
      }
      const bool complete = std::ranges::all_of(
          round.runs, [axes](const PlannedRun& run) { return run.values.size() == axes; });
      if (complete) rounds.push_back(std::move(round));
    } catch (const std::exception&) {  // of nlohmann::json, or of wholeNumber()
      continue;
    }
  }
  return rounds;
}

std::vector<std::size_t> openRows(const CampaignData& data,
                                  const std::vector<AdaptiveRound>& rounds) {
  std::map<std::string_view, std::size_t> rows;
  for (std::size_t i = 0; i < data.rows.size(); ++i) rows[data.rows[i].identity.recipe] = i;
  std::vector<std::size_t> open;
  for (const AdaptiveRound& round : rounds) {
    for (const PlannedRun& run : round.runs) {
      const auto row = rows.find(run.recipe);
      if (row != rows.end() && !wasTried(data.survey.rows[row->second])) {
        open.push_back(row->second);
      }
    }
  }
  std::ranges::sort(open);
  open.erase(std::unique(open.begin(), open.end()), open.end());
  return open;
}

std::string surfaceCsv(const CampaignData& data, const GoalState& state) {
  std::string text;
  for (const Axis& axis : data.axes) text += axis.key + ",";
  const std::string& quantity = data.request.adaptive->quantity;
  text += fmt::format("{},{}.standard_error\n", quantity, quantity);
  for (const SurfacePoint& point : state.surface) {
    for (const std::string& value : data.points[point.candidate].values) text += value + ",";
    text += fmt::format("{:.6g},{:.6g}\n", point.value, point.sigma);
  }
  return text;
}

std::string boundaryCsv(const CampaignData& data, const GoalState& state) {
  const CampaignGoal goal = goalOf(data.request, data.points);
  const std::string& first = data.axes[goal.axes.front()].key;
  std::string text;
  for (std::size_t k = 1; k < goal.axes.size(); ++k) text += data.axes[goal.axes[k]].key + ",";
  text += fmt::format("{},{}.standard_error\n", first, first);
  for (const Crossing& crossing : state.crossings) {
    for (std::size_t k = 1; k < goal.axes.size(); ++k) {
      text += data.points[crossing.candidate].values[goal.axes[k]] + ",";
    }
    text += fmt::format("{:.6g},{:.6g}\n", crossing.position, crossing.sigma);
  }
  return text;
}

}  // namespace lab::runner::campaign
