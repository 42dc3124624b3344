/// The collective results of a record.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "analyzer/collective/crowd_analysis.hpp"
#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// @param start time of the analysis at the start of the record [s]
/// @param key_of the key into RunRecord::programs of a group
void fillCrowds(const collective::CrowdAnalysis& analysis, double start,
                const std::function<int(int group)>& key_of, RunRecord& record);

/// "all robots", or the name of the program.
[[nodiscard]] std::string crowdName(const RunRecord& record, const CrowdRecord& crowd);

/// The groups that are shown: without a program that all robots ran nearly all the time, which has
/// the numbers of all robots.
[[nodiscard]] std::vector<const CrowdRecord*> shownCrowds(const RunRecord& record);

/// Whether frames have more robots than collective numbers take into account.
[[nodiscard]] bool isCrowdCut(const RunRecord& record);

/// Whether there are enough robots for a section and figures.
[[nodiscard]] bool isCrowd(const RunRecord& record);

}  // namespace lab::report
