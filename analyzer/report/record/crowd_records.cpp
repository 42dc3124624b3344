#include "analyzer/report/record/crowd_records.hpp"

#include <cstdint>
#include <string>
#include <utility>

namespace lab::report {
namespace {

constexpr std::size_t kMostStretches = 60;  // in pictures over time
constexpr double kFewestRobots = 4;         // mean number; fewer have no structure

}  // namespace

void fillCrowds(const collective::CrowdAnalysis& analysis, double start,
                const std::function<int(int group)>& key_of, RunRecord& record) {
  for (collective::CrowdResult& result : analysis.results()) {
    CrowdRecord crowd;
    const int group = result.group;
    crowd.program = group == collective::CrowdAnalysis::kAll ? -1 : key_of(group);
    crowd.result = std::move(result);
    const collective::CrowdGroup& of_robots = *analysis.group(group);
    crowd.stretches = of_robots.stretches(kMostStretches);
    for (collective::Stretch& stretch : crowd.stretches) {
      stretch.begin -= start;
      stretch.end -= start;
    }
    crowd.map = of_robots.map();
    record.crowds.push_back(std::move(crowd));
  }
  record.crowd_picture = analysis.picture();
  record.crowd_picture.time -= start;
  record.crowd_left_out = static_cast<std::int64_t>(analysis.leftOut());
  record.crowd_most = static_cast<std::int64_t>(analysis.mostRobots());
}

std::string crowdName(const RunRecord& record, const CrowdRecord& crowd) {
  return crowd.program < 0 ? "all robots" : record.programNameOf(crowd.program);
}

std::vector<const CrowdRecord*> shownCrowds(const RunRecord& record) {
  constexpr double kNearly = 0.98;
  std::vector<const CrowdRecord*> shown;
  for (const CrowdRecord& crowd : record.crowds) {
    const collective::CrowdResult& all = record.crowds.front().result;
    const bool same = crowd.program >= 0 && crowd.result.robots > kNearly * all.robots &&
                      crowd.result.observed > kNearly * all.observed;
    if (!same) shown.push_back(&crowd);
  }
  return shown;
}

bool isCrowdCut(const RunRecord& record) {
  return record.crowd_most > static_cast<std::int64_t>(collective::CrowdAnalysis::kMostRobots);
}

bool isCrowd(const RunRecord& record) {
  return !record.crowds.empty() && record.crowds.front().result.robots >= kFewestRobots;
}

}  // namespace lab::report
