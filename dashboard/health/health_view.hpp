/// How every process and every stream of the lab is.
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
#include "dashboard/views/json.hpp"

namespace lab::dashboard {

struct ServiceRow {
  service_status_t status{};
  std::int64_t heard_utime = 0;
  int starts = 1;  ///< how often it was started, as far as it was heard

  [[nodiscard]] bool hasEnded() const { return status.state == service_status_t::ENDED; }
};

struct StreamRow {
  std::int64_t heard_utime = 0;
  double rate = 0;                         ///< [1/s] over the last seconds
  std::int64_t new_losses = 0;             ///< over the same time
  std::array<std::int64_t, 5> received{};  ///< second by second
  std::array<std::int64_t, 5> lost{};
  std::int64_t ticks = 0;
};

class HealthView {
 public:
  static constexpr std::size_t kMostServices = 200;
  static constexpr std::size_t kMostStreams = 400;
  static constexpr std::int64_t kSilent_us = 3'000'000;  ///< of a service

  /// Every message of the lab, whether it is decoded or not.
  void count(std::string_view channel, const MessageHeader& header, std::int64_t now);

  /// Of a type that is not ours, or broken.
  void countNotUnderstood(std::string_view channel);

  void take(const service_status_t& status, std::int64_t now);
  void take(const tracker_status_t& status, std::int64_t now);
  void take(const link_status_t& status, std::int64_t now);

  /// Once a second: rates.
  void tick(std::int64_t now);
  void clear();

  /// Processes on this host.
  [[nodiscard]] std::vector<std::int32_t> pids(const std::string& host) const;

  /// "services", "streams", "not_understood", "tracker", "links" of topic `health`.
  /// @param uses of the processes on `host`
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
  /// Pictures that the tracker found too bright, or too dark, since the tick before.
  [[nodiscard]] std::int64_t newSaturated() const { return new_saturated_; }
  [[nodiscard]] std::int64_t newDark() const { return new_dark_; }
  /// Senders whose clock is ahead of ours [s], by name: those more than a second.
  [[nodiscard]] const std::map<std::string, double>& ahead() const { return ahead_; }
  [[nodiscard]] std::int64_t streamsLeftOut() const { return streams_left_out_; }

 private:
  [[nodiscard]] Json servicesJson(std::int64_t now, const std::string& host,
                                  const std::map<std::int32_t, ProcessUse>& uses) const;
  [[nodiscard]] Json streamsJson(std::int64_t now) const;

  std::map<std::pair<std::string, std::string>, ServiceRow> services_;  ///< by name and host
  StreamCounter counter_;
  std::map<StreamKey, StreamRow> rows_;
  std::pair<const StreamKey, StreamRow>* last_ = nullptr;  ///< most messages come in runs
  std::map<std::string, std::int64_t> not_understood_;
  std::optional<tracker_status_t> tracker_;
  std::optional<tracker_status_t> tracker_before_;  ///< at the tick before
  std::int64_t tracker_utime_ = 0;
  std::int64_t new_saturated_ = 0;
  std::int64_t new_dark_ = 0;
  std::map<std::string, link_status_t> links_;  ///< by host
  std::map<std::string, double> ahead_;
  std::int64_t streams_left_out_ = 0;
};

}  // namespace lab::dashboard
