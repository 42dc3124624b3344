#include "dashboard/views/run_times.hpp"

#include <algorithm>

#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace {

constexpr std::size_t kMaxRobots = 500;

}  // namespace

void RunTimes::take(const robot_status_t& status) {
  for (const robot_state_t& state : status.robots) {
    if (runRate(run_info_.indexOf(state.program)) > 0) {
      take(state);
    } else {
      robots_.erase(state.robot_id);
    }
  }
}

void RunTimes::take(const robot_state_t& state) {
  const auto found = robots_.find(state.robot_id);
  const bool known = found != robots_.end() && found->second.epoch == state.program_epoch &&
                     state.run_time >= found->second.before;
  if (!known) {
    if (found != robots_.end() || robots_.size() < kMaxRobots) {
      robots_[state.robot_id] = {state.program_epoch, state.tumble_count, state.run_time};
    }
    return;
  }
  Robot& robot = found->second;
  if (state.tumble_count == robot.tumbles) {
    robot.run_time = std::min(robot.run_time, state.run_time);
    return;
  }
  const bool next = state.tumble_count == robot.tumbles + 1;
  // The run between the previous tumble, whose begin was observed, and this one.
  if (next && robot.whole) add(state.program, state.run_time - robot.run_time);
  robot.before = robot.run_time;
  robot.run_time = state.run_time;
  robot.tumbles = state.tumble_count;
  robot.whole = next;
}

double RunTimes::runRate(int program) const {
  if (program < 0) return 0;
  const std::string& name = run_info_.programs()[static_cast<std::size_t>(program)];
  for (const auto& [parameter, value] : run_info_.experiment().programs.at(name).law.parameters) {
    if (parameter == "gamma") return value;
  }
  return 0;
}

void RunTimes::add(const program_id_t& program, double run) {
  const int index = run_info_.indexOf(program);
  const double rate = runRate(index);
  if (!(rate > 0) || !(run >= 0)) return;
  Histogram& histogram = programs_[run_info_.programs()[static_cast<std::size_t>(index)]];
  histogram.gamma = rate;
  histogram.changed = true;
  ++histogram.runs;
  histogram.sum += run;
  const double bin = run * rate * kBinsPerMeanRun;
  if (bin < kBins) ++histogram.counts[static_cast<std::size_t>(bin)];
}

void RunTimes::clear() {
  robots_.clear();
  programs_.clear();
}

std::vector<std::string> RunTimes::takeChanged() {
  std::vector<std::string> names;
  for (auto& [name, histogram] : programs_) {
    if (histogram.changed) names.push_back(name);
    histogram.changed = false;
  }
  return names;
}

std::string RunTimes::json(const std::string& program) const {
  const auto found = programs_.find(program);
  if (found == programs_.end()) return {};
  const Histogram& histogram = found->second;
  Json edges = Json::array();
  for (std::size_t i = 0; i <= kBins; ++i) {
    edges.push_back(number(static_cast<double>(i) / (histogram.gamma * kBinsPerMeanRun)));
  }
  return toText({{"program", program},
                 {"gamma_per_s", number(histogram.gamma)},
                 {"edges_s", std::move(edges)},
                 {"counts", histogram.counts},
                 {"runs", histogram.runs},
                 {"mean_s", number(histogram.sum / static_cast<double>(histogram.runs))}});
}

}  // namespace lab::dashboard
