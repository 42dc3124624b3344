/// Converts messages into the input of the collective analysis. Used by the online analyzer and for
/// closed logs.
#pragma once

#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <vector>

#include "analyzer/collective/crowd_analysis.hpp"
#include "analyzer/service/program_keys.hpp"
#include "common/experiment/experiment.hpp"

namespace lab::analysis {

[[nodiscard]] collective::CrowdConfig crowdConfig(const Experiment& experiment);

/// Takes messages in the order in which they arrive. The program and the light band of a robot are
/// those of its last report, which is at most one period of ROBOT_STATUS old. The same messages in
/// the same order give the same bits.
class CollectiveFeed {
 public:
  explicit CollectiveFeed(const Experiment& experiment);

  void take(const tracked_frame_t& frame);
  void take(const robot_status_t& status);

  [[nodiscard]] const collective::CrowdAnalysis& analysis() const { return analysis_; }

  /// The program of a group; hash 0 for all robots.
  [[nodiscard]] program_id_t programOf(int group) const;

  /// Time of the last evaluated frame [us since 1970]; 0: none yet.
  [[nodiscard]] std::int64_t pictureUtime() const;

  /// The time of the analysis (s) for a time of the messages.
  [[nodiscard]] double seconds(std::int64_t utime) const;

 private:
  struct Reported {
    int program = -1;
    int band = -1;
    std::int64_t utime = 0;
  };

  collective::CrowdAnalysis analysis_;
  int bands_;  ///< rows of the light table
  ProgramKeys keys_;
  std::map<std::int32_t, Reported> reported_;
  std::vector<collective::CrowdPose> poses_;  ///< kept to reuse its memory
  std::int64_t origin_utime_ = 0;
};

}  // namespace lab::analysis
