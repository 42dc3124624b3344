/// What happened in the run: steps of the light, marks, faults, its end; and how the script stands.
#pragma once

#include <cstdint>
#include <deque>
#include <lab/experiment_event_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <lab/light_delivery_t.hpp>
#include <map>
#include <optional>
#include <string>

namespace lab::dashboard {

class TimelineView {
 public:
  static constexpr std::size_t kMostSteps = 500;
  static constexpr std::size_t kMostRemarks = 500;

  /// Everything is said several times, because a message may be lost; STEP with more each time.
  void take(const experiment_event_t& event);

  /// How long the script has run says when it began, also to who came late. Pauses are not in it:
  /// the earliest answer holds.
  void take(const experiment_status_t& status);
  void clear();

  /// Of topic `timeline`. Of remarks that are too many, the oldest are left out and counted.
  [[nodiscard]] std::string json() const;

  [[nodiscard]] std::int64_t startUtime() const { return start_utime_; }
  [[nodiscard]] bool ended() const { return end_.has_value(); }
  /// Counts changes.
  [[nodiscard]] std::uint64_t version() const { return version_; }

 private:
  struct Remark {
    std::int64_t utime = 0;
    std::string text;
    bool operator==(const Remark&) const = default;
  };
  struct Remarks {
    std::deque<Remark> newest;
    std::int64_t before = 0;  ///< left out
    bool add(const experiment_event_t& event);
  };

  std::int64_t start_utime_ = 0;
  bool counted_back_ = false;  ///< else the start is when START was heard first
  std::map<std::int32_t, experiment_event_t> steps_;
  std::int64_t steps_before_ = 0;
  Remarks marks_;
  Remarks faults_;
  std::optional<Remark> end_;
  std::uint64_t version_ = 0;
};

/// Of topic `delivery`.
[[nodiscard]] std::string deliveryJson(const light_delivery_t& delivery);

/// Of topic `script`.
[[nodiscard]] std::string scriptJson(const experiment_status_t& status);

/// Of topic `player`.
[[nodiscard]] std::string playerJson(const experiment_status_t& status);

/// Whether the status is of a log that is played.
[[nodiscard]] bool isPlayed(const experiment_status_t& status);

}  // namespace lab::dashboard
