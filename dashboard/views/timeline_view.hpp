/// The events of a run (light steps, marks, faults, the end) and the state of the script.
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

/// Collects EXPERIMENT_EVENT and the start of the script.
class TimelineView {
 public:
  static constexpr std::size_t kMaxSteps = 500;
  static constexpr std::size_t kMaxRemarks = 500;

  /// Adds an event. Events are sent several times because LCM may drop messages. A later STEP event
  /// of the same step replaces the earlier one, because it has more facts.
  void take(const experiment_event_t& event);

  /// Computes the start of the script from the time that has elapsed in it, so a dashboard that was
  /// started late knows it too. The elapsed time does not include pauses, so after a pause the
  /// computed start is too late; the earliest one is kept.
  void take(const experiment_status_t& status);
  void clear();

  /// JSON of topic `timeline`. If there are too many events, the oldest are omitted and
  /// counted.
  [[nodiscard]] std::string json() const;

  [[nodiscard]] std::int64_t startUtime() const { return start_utime_; }
  [[nodiscard]] bool ended() const { return end_.has_value(); }
  /// Changes with every change of the timeline.
  [[nodiscard]] std::uint64_t version() const { return version_; }

 private:
  struct Remark {
    std::int64_t utime = 0;
    std::string text;
    bool operator==(const Remark&) const = default;
  };
  struct Remarks {
    std::deque<Remark> newest;
    std::int64_t before = 0;  ///< number of omitted remarks
    bool add(const experiment_event_t& event);
  };

  std::int64_t start_utime_ = 0;
  bool counted_back_ = false;  ///< start_utime_ comes from the elapsed time, not from a START event
  std::map<std::int32_t, experiment_event_t> steps_;
  std::int64_t steps_before_ = 0;
  Remarks marks_;
  Remarks faults_;
  std::optional<Remark> end_;
  std::uint64_t version_ = 0;
};

/// JSON of topic `delivery`.
[[nodiscard]] std::string deliveryJson(const light_delivery_t& delivery);

/// JSON of topic `script`.
[[nodiscard]] std::string scriptJson(const experiment_status_t& status);

/// JSON of topic `player`.
[[nodiscard]] std::string playerJson(const experiment_status_t& status);

/// Whether the status comes from the replay of a log.
[[nodiscard]] bool isPlayed(const experiment_status_t& status);

}  // namespace lab::dashboard
