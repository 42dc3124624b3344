/// Condition that ends a step of the light script.
#pragma once

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/collective_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "common/experiment/experiment.hpp"
#include "runner/script/crowd_value.hpp"
#include "runner/script/estimate_precision.hpp"
#include "runner/script/tumble_count.hpp"

namespace lab::runner {

/// The condition of one step, from the beginning of the step. Gets the messages of the lab and
/// decides whether the condition is met, and by which sample.
class StepCondition {
 public:
  /// @param tumbles count at the beginning of the step
  /// @param utime beginning of the step; earlier samples are ignored
  StepCondition(const Experiment& experiment, const EndCondition& until, const TumbleCount& tumbles,
                std::int64_t utime);

  void take(const tracked_frame_t& frame);
  void take(const analysis_t& analysis);
  void take(const collective_t& message);
  void take(const TumbleCount& tumbles);

  /// utime of the sample that met the condition; nothing if it is not met.
  [[nodiscard]] std::optional<std::int64_t> met() const { return met_; }

  /// Progress as text: "relative error 0.12, wanted 0.05".
  [[nodiscard]] std::string progress() const;

 private:
  /// Distance from the region [m]; 0 inside.
  [[nodiscard]] double distance(const tracked_pose_t& pose) const;
  [[nodiscard]] bool concerns(std::int32_t robot) const;

  EndCondition until_;
  EstimatePrecision estimate_;
  CrowdCondition crowd_;
  std::set<std::int32_t> robots_;  ///< all robots of the experiment
  std::int64_t begin_utime_;
  std::optional<std::int64_t> met_;

  std::map<std::int32_t, std::int64_t>
      inside_;  ///< robots inside the region, with the utime of their last pose
  std::size_t most_inside_ = 0;
  double nearest_ = std::numeric_limits<double>::infinity();  ///< [m]
  std::int32_t nearest_robot_ = 0;
  std::int64_t tumbles_before_;
  std::int64_t tumbles_ = 0;
};

}  // namespace lab::runner
