#include "runner/campaign/adaptive/adaptive_goal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "common/text/nearest_word.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace {

constexpr std::size_t kMostCandidates = 1000;  // of matrices of this size
constexpr std::size_t kNamedColumns = 8;
constexpr const char* kDurationKey = "duration_s";

UserError badPlan(const Request& request, const std::string& what) {
  return UserError(fmt::format("{}: sweep.adaptive{}", request.file, what));
}

/// The swept keys but for the length of the run, each with at least two values.
std::vector<std::size_t> keyAxes(const Request& request, const std::vector<Axis>& axes,
                                 const std::vector<Point>& points) {
  std::vector<std::size_t> chosen;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    if (axes[axis].key == kDurationKey) continue;
    std::set<std::string> values;
    for (const Point& point : points) values.insert(point.values[axis]);
    if (values.size() < 2) continue;
    for (const std::string& value : values) {
      const auto number = numberIn(value);
      const bool law = request.adaptive->goal == AdaptiveGoal::kLaw;
      if (number && (!law || *number > 0)) continue;
      throw badPlan(request,
                    fmt::format(": found {}={}, expected {}numbers for all swept keys{}",
                                axes[axis].key, value, law ? "positive " : "",
                                law ? ", because a power law has no others; goal = \"mean\" needs "
                                      "no law"
                                    : ""));
    }
    chosen.push_back(axis);
  }
  if (chosen.empty()) {
    throw badPlan(request,
                  ": found no swept key with two values beside duration_s, expected at least one "
                  "(sweep.over, or --over KEY=1,2,3)");
  }
  return chosen;
}

void requireEnd(const Request& request) {
  const AdaptivePlan& plan = *request.adaptive;
  if (plan.robot_time_s > 0 || plan.error > 0) return;
  throw badPlan(request,
                ": found neither robot_time_s nor error, expected one of them: otherwise all runs "
                "of the grid are made, as without --adaptive");
}

void requireIndependent(const Request& request) {
  if (request.common_seeds) {
    throw badPlan(request,
                  ": found --common-seeds, expected independent seeds: the errors of the points "
                  "would be correlated; leave it out");
  }
  if (request.live && !request.live->known.empty()) {
    throw badPlan(request,
                  ": found --known, expected sweep.adaptive.error in its place; leave it out");
  }
}

/// Whether a swept key is meant: in full, its last part, or that without its unit.
bool isKey(const Axis& axis, const std::string& name) {
  return axis.key == name || axis.key.ends_with("." + name) || axis.symbol() == name;
}

void setParameter(CampaignGoal& goal, const Request& request, const std::vector<Axis>& axes,
                  const std::vector<std::size_t>& keys) {
  const std::string& name = goal.plan.parameter;
  if (goal.plan.relative && goal.plan.goal != AdaptiveGoal::kMean) {
    throw badPlan(request,
                  ".relative: found true, expected none: it is for goal = \"mean\" only (a law is "
                  "relative in any case)");
  }
  if (goal.plan.goal != AdaptiveGoal::kLaw) {
    if (name.empty()) return;
    throw badPlan(request, fmt::format(".parameter: found \"{}\", expected none: parameters are "
                                       "those of goal = \"law\"",
                                       name));
  }
  if (name.empty() || name == "exponents") return;
  if (name == "prefactor" || name == "curve") {
    goal.parameter = name == "curve" ? LawParameter::kCurve : LawParameter::kPrefactor;
    return;
  }
  const auto key =
      std::ranges::find_if(keys, [&](std::size_t axis) { return isKey(axes[axis], name); });
  if (key == keys.end()) {
    std::vector<std::string> words{"exponents", "prefactor", "curve"};
    for (const std::size_t axis : keys) words.push_back(axes[axis].symbol());
    throw badPlan(request, fmt::format(".parameter: found \"{}\", expected one of {}{}", name,
                                       fmt::join(words, ", "), didYouMean(name, words)));
  }
  goal.parameter = LawParameter::kOneExponent;
  goal.key = static_cast<std::size_t>(key - keys.begin());
}

/// The column that is meant. @throws UserError
std::string columnOf(const Request& request, const PooledTable& pooled) {
  const std::string& name = request.adaptive->quantity;
  std::vector<std::string> meant;
  std::vector<std::string> known;
  for (const Quantity& quantity : pooled.quantities) {
    if (!quantity.has_errors) continue;
    known.push_back(quantity.name);
    if (quantity.name == name || quantity.name.ends_with("." + name)) {
      meant.push_back(quantity.name);
    }
  }
  if (std::ranges::find(meant, name) != meant.end()) return name;
  if (meant.size() == 1) return meant.front();
  const bool several = !meant.empty();
  const std::vector<std::string>& list = several ? meant : known;
  const std::size_t listed = std::min(list.size(), kNamedColumns);
  throw badPlan(
      request,
      fmt::format(".quantity: found \"{}\", which {}; expected one of {}{}{}", name,
                  several ? "several columns are" : "no estimate of the runs has as its name",
                  fmt::join(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(listed), ", "),
                  listed < list.size() ? ", ..." : "", several ? "" : didYouMean(name, known)));
}

}  // namespace

CampaignGoal goalOf(const Request& request, const std::vector<Point>& points) {
  CampaignGoal goal;
  goal.plan = request.adaptive.value();
  requireEnd(request);
  requireIndependent(request);
  if (points.size() > kMostCandidates) {
    throw badPlan(request, fmt::format(": found {} points, expected at most {}; sweep fewer values",
                                       points.size(), kMostCandidates));
  }
  const std::vector<Axis> axes = request.design().axes;
  const std::vector<std::size_t> keys = keyAxes(request, axes, points);
  goal.axes = keys;
  setParameter(goal, request, axes, keys);
  // On a real lab the robots rest in that time.
  const double between =
      std::max(goal.plan.between_runs_s, request.live ? request.live->rest_s : 0.0);
  double shortest = 0;
  for (const Point& point : points) {
    Candidate candidate{{}, point.duration};
    for (const std::size_t axis : keys) candidate.keys.push_back(*numberIn(point.values[axis]));
    goal.candidates.push_back(std::move(candidate));
    goal.costs.push_back(point.duration + between);
    if (shortest == 0 || goal.costs.back() < shortest) shortest = goal.costs.back();
  }
  if (goal.plan.robot_time_s > 0 && goal.plan.robot_time_s < shortest) {
    throw badPlan(request,
                  fmt::format(".robot_time_s: found {:g}, expected at least {:g}, the shortest run",
                              goal.plan.robot_time_s, shortest));
  }
  return goal;
}

GoalState CampaignGoal::state(const std::vector<RunValue>& runs) const {
  if (plan.goal == AdaptiveGoal::kMean) return surfaceState(plan, candidates, runs);
  if (plan.goal == AdaptiveGoal::kBoundary) return boundaryState(plan.level, candidates, runs);
  return lawState(parameter, key, candidates, runs);
}

GaussianDesign CampaignGoal::spread(const std::vector<RunValue>& runs) const {
  AdaptivePlan mean = plan;
  mean.relative = plan.relative || plan.goal == AdaptiveGoal::kLaw;
  return surfaceState(mean, candidates, runs).design;
}

std::vector<RunValue> valuesOf(const CampaignData& data) {
  std::vector<RunValue> values;
  const bool any = std::ranges::any_of(
      data.survey.rows, [](const RowState& state) { return state.result.has_value(); });
  if (!any) return values;
  const std::string column = columnOf(data.request, poolCampaign(data));
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const auto& result = data.survey.rows[i].result;
    if (!result) continue;
    const RunValue value{data.rows[i].point, numberOf(*result, column),
                         numberOf(*result, column + ".standard_error"),
                         numberOf(*result, column + ".effective_samples")};
    if (std::isfinite(value.value)) values.push_back(value);
  }
  return values;
}

}  // namespace lab::runner::campaign
