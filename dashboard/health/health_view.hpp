/// State of every service and every message stream of the lab.
#pragma once

#include <array>
#include <cstdint>
#include <lab/link_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/tracker_status_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/message_header.hpp"
#include "common/bus/stream_counter.hpp"
#include "dashboard/health/process_meter.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {

struct ServiceRow {
  service_status_t status{};
  std::int64_t heard_utime = 0;
  int starts = 1;  ///< observed number of starts

  [[nodiscard]] bool hasEnded() const { return status.state == service_status_t::ENDED; }
};

struct StreamRow {
  std::int64_t heard_utime = 0;
  double rate = 0;                         ///< [1/s] over the last seconds
  std::int64_t new_losses = 0;             ///< in the same time
  std::array<std::int64_t, 5> received{};  ///< totals, one per second
  std::array<std::int64_t, 5> lost{};
  std::int64_t ticks = 0;
};

/// "waiting", "running", "gone", "ended" or "unknown".
[[nodiscard]] const char* trackerStateName(std::int8_t state);

/// Collects what topic `health` shows. Times are us since 1970.
class HealthView {
 public:
  static constexpr std::size_t kMaxServices = 200;
  static constexpr std::size_t kMaxStreams = 400;
  static constexpr std::int64_t kSilent_us =
      3'000'000;  ///< a service that sends nothing for longer is silent

  /// Counts a message. Call it for every message, whether it is decoded or not.
  void count(std::string_view channel, const MessageHeader& header, std::int64_t now);

  /// Counts a message of an unknown type or a damaged one.
  void countNotUnderstood(std::string_view channel, std::int64_t count = 1);

  void take(const service_status_t& status, std::int64_t now);
  void take(const tracker_status_t& status, std::int64_t now);
  void take(const link_status_t& status, std::int64_t now);

  /// Updates the rates. Call it once per second.
  void tick(std::int64_t now);
  void clear();

  /// Process ids of the lab's services on `host`.
  [[nodiscard]] std::vector<std::int32_t> pids(const std::string& host) const;

  /// The entries "services", "streams", "not_understood", "tracker" and "links" of topic `health`.
  /// @param uses resources used by the processes on `host`, by process id
  [[nodiscard]] Json json(std::int64_t now, const std::string& host,
                          const std::map<std::int32_t, ProcessUse>& uses) const;

  [[nodiscard]] const std::map<std::pair<std::string, std::string>, ServiceRow>& services() const {
    return services_;
  }
  [[nodiscard]] const std::map<StreamKey, StreamRow>& streams() const { return rows_; }
  [[nodiscard]] const StreamCounter& counter() const { return counter_; }
  [[nodiscard]] const std::map<std::string, std::int64_t>& notUnderstood() const {
    return not_understood_;
  }
  [[nodiscard]] const std::optional<tracker_status_t>& tracker() const { return tracker_; }
  [[nodiscard]] const std::map<std::string, link_status_t>& links() const { return links_; }
  /// Pictures since the previous tick that the tracker reported as too bright or too dark.
  [[nodiscard]] std::int64_t newSaturated() const { return new_saturated_; }
  [[nodiscard]] std::int64_t newDark() const { return new_dark_; }
  /// Senders whose clock is more than a second ahead of this host's, by name [s].
  [[nodiscard]] const std::map<std::string, double>& ahead() const { return ahead_; }
  [[nodiscard]] std::int64_t streamsLeftOut() const { return streams_left_out_; }

 private:
  [[nodiscard]] Json servicesJson(std::int64_t now, const std::string& host,
                                  const std::map<std::int32_t, ProcessUse>& uses) const;
  [[nodiscard]] Json streamsJson(std::int64_t now) const;

  std::map<std::pair<std::string, std::string>, ServiceRow> services_;  ///< by name and host
  StreamCounter counter_{kMaxStreams};
  std::map<StreamKey, StreamRow> rows_;
  std::pair<const StreamKey, StreamRow>* last_ =
      nullptr;  ///< cache: successive messages often belong to one stream
  std::map<std::string, std::int64_t> not_understood_;
  std::optional<tracker_status_t> tracker_;
  std::optional<tracker_status_t> tracker_before_;  ///< at the previous tick
  std::int64_t tracker_utime_ = 0;
  std::int64_t new_saturated_ = 0;
  std::int64_t new_dark_ = 0;
  std::map<std::string, link_status_t> links_;  ///< by host
  std::map<std::string, double> ahead_;
  std::int64_t streams_left_out_ = 0;
};

}  // namespace lab::dashboard
