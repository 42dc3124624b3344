/// The online analyzer.
#pragma once

#include <vector>

#include "analyzer/analysis_feed.hpp"
#include "common/service/service_main.hpp"

namespace lab::analysis {

/// Listens to frames, robots and light, and publishes what the motion shows so far: one ANALYSIS
/// message per program for the pool of its robots and for each robot, each once a second, spread
/// evenly over it.
class AnalyzerService final : public Service {
 public:
  explicit AnalyzerService(const ServiceContext& context);

 private:
  void beginRound();
  void publishDue();

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  AnalysisFeed feed_;
  std::vector<FeedResult> round_;  ///< The results of this second,
  std::size_t published_ = 0;      ///< how many of which are out,
  std::int64_t round_utime_ = 0;   ///< and the last frame in them [us since 1970].
  int slot_ = 0;                   ///< Of the second.
};

/// What serviceMain() and the lab in one process need to know.
[[nodiscard]] ServiceDescription serviceDescription();

}  // namespace lab::analysis
