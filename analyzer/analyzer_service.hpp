/// The online analyzer.
#pragma once

#include <cstdint>
#include <lab/collective_t.hpp>
#include <vector>

#include "analyzer/analysis_feed.hpp"
#include "analyzer/service/collective_feed.hpp"
#include "analyzer/service/load_shedding.hpp"
#include "analyzer/service/result_schedule.hpp"
#include "common/service/service_main.hpp"

namespace lab::analysis {

/// Listens to frames, robots and light, and publishes the results so far: one ANALYSIS message per
/// program for the pool of its robots and one for each robot, and one COLLECTIVE message for all
/// robots and one per program. Each is sent once a second, or as ResultSchedule says, evenly spread
/// over the second. Under overload it first computes results less often, then skips camera frames
/// (LoadShedding); the heartbeat says so and counts the frames.
class AnalyzerService final : public Service {
 public:
  explicit AnalyzerService(const ServiceContext& context,
                           ResultReaders readers = ResultReaders::kLive);

 private:
  void take(const tracked_frame_t& frame);
  void beginRound();
  void publishDue();
  void keepAlive();
  void noteOverload();

  Node& node_;
  Loop& loop_;
  const Experiment& experiment_;
  AnalysisFeed feed_;
  CollectiveFeed crowd_;
  /// Whether the first robot state that the feed refused was reported as an error.
  bool refused_state_noted_ = false;
  std::vector<collective_t> crowd_round_;  ///< Results of the current second, sent first.
  std::vector<FeedResult> round_;          ///< The same of single robots and programs.
  std::size_t published_ = 0;              ///< Number of both already published.
  std::int64_t round_utime_ = 0;           ///< Last frame in them [us since 1970].
  ResultSchedule schedule_;
  LoadShedding shedding_;
  /// Start of the computation of the current results [us since 1970].
  std::int64_t begin_utime_ = 0;
  std::int64_t alive_utime_ = 0;  ///< Last heartbeat while results are computed.
  std::int64_t intended_us_ = 0;  ///< From the results before to the current ones.
  int slot_ = 0;                  ///< Slot within the second.
};

/// For serviceMain() and for the lab in one process.
[[nodiscard]] ServiceDescription serviceDescription(ResultReaders readers = ResultReaders::kLive);

}  // namespace lab::analysis
