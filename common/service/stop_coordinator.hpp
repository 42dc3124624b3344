/// ROBOT_STOP and who has obeyed it: no bus, no clock.
#pragma once

#include <cstdint>
#include <deque>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lab {

/// Asks robots to stop or to go on, until each has said that it does, and follows what others ask.
/// The last request holds. Robots that stand though no request is known have been asked by somebody
/// who was not heard: that counts as a stop of all. Robots of a replay obey nobody and are not
/// counted. Times are us since 1970.
class StopCoordinator {
 public:
  enum class State { kFree, kStopping, kStopped, kReleasing };

  static constexpr std::int64_t kRepeat_us = 100'000;
  /// Robots that never answer are asked to go on for so long, and nobody at all to stop.
  static constexpr std::int64_t kTimeout_us = 5'000'000;
  /// Within it every robot is heard: every owner reports at 20 Hz or faster.
  static constexpr std::int64_t kDiscovery_us = 300'000;

  /// A robot that has to obey, though nothing may have been heard of it.
  void expect(std::int32_t robot) { obeys_.try_emplace(robot, false); }

  /// Asks every robot.
  /// @param seq of the request, new each time
  void stop(std::string by, std::string reason, std::int64_t seq, std::int64_t now) {
    ask(std::move(by), std::move(reason), seq, 0, now);
  }
  void release(std::string by, std::string reason, std::int64_t seq, std::int64_t now) {
    ask(std::move(by), std::move(reason), seq, 1, now);
  }

  void take(const robot_status_t& status, std::int64_t now);

  /// What was heard on the bus; own requests that come back change nothing.
  void take(const robot_stop_t& stop, std::int64_t now);

  /// The request that is to be sent now, header left empty but for utime and seq: at once, then at
  /// 10 Hz until every robot obeys, and again when one does not any more. For robots that have not
  /// been heard yet it is repeated at least for kDiscovery_us.
  [[nodiscard]] std::optional<robot_stop_t> due(std::int64_t now);

  /// Another run begins, and no robot of it is known. What was asked here stays in force until it
  /// is released here or by others.
  void newRun();

  [[nodiscard]] State state() const;
  [[nodiscard]] const std::string& by() const { return by_; }
  [[nodiscard]] const std::string& reason() const { return request_.reason; }

  /// Robots that are asked, those that obey not among them.
  [[nodiscard]] std::vector<std::int32_t> unconfirmed() const;

  /// Robots that are asked; without a request all that are known.
  [[nodiscard]] std::size_t total() const;

  /// Every robot that is asked obeys, and there is one.
  [[nodiscard]] bool confirmed() const;

  /// From the request to the answer of the last robot.
  [[nodiscard]] std::optional<std::int64_t> took() const { return response_time_us_; }

 private:
  void ask(std::string by, std::string reason, std::int64_t seq, std::int8_t clear,
           std::int64_t now);
  void begin(const robot_stop_t& request, std::string by, bool own, std::int64_t now);
  [[nodiscard]] bool isAsked(std::int32_t robot) const;
  [[nodiscard]] bool isObeyedBy(const robot_state_t& robot) const;
  void adopt(const robot_status_t& status, std::int64_t now);

  bool asked_ = false;  ///< whether there is a request
  bool own_ = false;
  bool adopted_ = false;  ///< the request was not heard: robots obey it
  std::string by_;
  robot_stop_t request_{};
  std::int64_t begun_utime_ = 0;
  std::int64_t sent_utime_ = 0;
  std::optional<std::int64_t> response_time_us_;
  std::map<std::int32_t, bool> obeys_;
  std::deque<std::int64_t> known_;  ///< seqs of the last requests: late repetitions are no news
};

}  // namespace lab
