/// Requests that robots stop or continue (ROBOT_STOP), and tracks which robots have complied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lab {

/// Requests that robots stop or continue, repeats the request until every robot reports that it
/// complies, and tracks the requests of others. The last request is in force. If robots report that
/// they are stopped although no request is known, it assumes that a request to all was lost.
/// Replayed robots take no requests and are not counted. Has neither bus nor clock: the caller
/// publishes due(). Times are us since 1970.
class StopCoordinator {
 public:
  enum class State { kFree, kStopping, kStopped, kReleasing };

  static constexpr std::int64_t kRepeat_us = 100'000;
  /// Timeout for unanswered releases, and for stops while no robot is known.
  static constexpr std::int64_t kTimeout_us = 5'000'000;
  /// Every robot reports within this time, because robots report at 20 Hz or faster.
  static constexpr std::int64_t kDiscovery_us = 300'000;
  /// Twice as many as a lab has in virtual time. Of more, only those of expect() are tracked.
  static constexpr std::size_t kMostRobots = 20'000;

  /// Adds a robot that must comply, even if it has not reported yet.
  void expect(std::int32_t robot) { complies_.try_emplace(robot, false); }

  /// Requests that all robots stop.
  /// @param by who requests it, for display
  /// @param seq of the request, new each time
  void stop(std::string by, std::string reason, std::int64_t seq, std::int64_t now) {
    request(std::move(by), std::move(reason), seq, 0, now);
  }
  /// Requests that all robots continue; parameters as for stop().
  void release(std::string by, std::string reason, std::int64_t seq, std::int64_t now) {
    request(std::move(by), std::move(reason), seq, 1, now);
  }

  void take(const robot_status_t& status, std::int64_t now);

  /// Handles a request from the bus. Own requests, which the bus returns, have no effect.
  void take(const robot_stop_t& stop, std::int64_t now);

  /// The request that must be sent now, with an empty header except for utime and seq. It is sent
  /// at once, then at 10 Hz until every robot complies, and again if one no longer complies. It is
  /// repeated for at least kDiscovery_us, for robots that have not reported yet.
  [[nodiscard]] std::optional<robot_stop_t> due(std::int64_t now);

  /// A new run begins, and none of its robots is known. A request made here stays in force until it
  /// is released here or by others.
  void newRun();

  [[nodiscard]] State state() const;
  [[nodiscard]] const std::string& by() const { return by_; }
  [[nodiscard]] const std::string& reason() const { return request_.reason; }

  /// The robots of the request that do not comply yet.
  [[nodiscard]] std::vector<std::int32_t> unconfirmed() const;

  /// The number of robots of the request; without a request, of all known robots.
  [[nodiscard]] std::size_t total() const;

  /// Whether there is a request with at least one robot, and all its robots comply.
  [[nodiscard]] bool confirmed() const;

  /// The time from the request until the last robot complied [us].
  [[nodiscard]] std::optional<std::int64_t> responseTime() const { return response_time_us_; }

 private:
  void request(std::string by, std::string reason, std::int64_t seq, std::int8_t clear,
               std::int64_t now);
  void begin(const robot_stop_t& request, std::string by, bool own, std::int64_t now);
  [[nodiscard]] bool isAddressed(std::int32_t robot) const;
  [[nodiscard]] bool compliesWithRequest(const robot_state_t& robot) const;
  void inferRequest(const robot_status_t& status, std::int64_t now);

  bool requested_ = false;  ///< whether there is a request
  bool own_ = false;
  bool inferred_ = false;  ///< the request was not received, but robots comply with it
  std::string by_;
  robot_stop_t request_{};
  std::int64_t begun_utime_ = 0;
  std::int64_t sent_utime_ = 0;
  std::optional<std::int64_t> response_time_us_;
  std::map<std::int32_t, bool> complies_;
  std::deque<std::int64_t> known_;  ///< seqs of the last requests, to recognise late repetitions
};

}  // namespace lab
