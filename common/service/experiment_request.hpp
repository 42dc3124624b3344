/// A request to a running experiment or a log playback (EXPERIMENT_COMMAND).
#pragma once

#include <cstddef>
#include <cstdint>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <string>
#include <string_view>

namespace lab {

/// Longest remark or reason [characters].
inline constexpr std::size_t kLongestRemark = 500;

/// Why a text cannot be a remark, which is UTF-8 without control characters; empty if it can.
[[nodiscard]] std::string remarkProblem(std::string_view text);

/// One request, repeated until EXPERIMENT_STATUS echoes it. It has neither bus nor clock: the
/// caller publishes message() and passes statuses. Times are us since 1970.
class ExperimentRequest {
 public:
  static constexpr std::int64_t kRepeat_us = 200'000;  // 5 Hz
  static constexpr std::int64_t kTimeout_us = 5'000'000;

  /// @param request action, value and text
  /// @param sender, instance of the node that publishes the request
  /// @param seq a new one for each request of this node
  ExperimentRequest(experiment_command_t request, const std::string& sender, std::int64_t instance,
                    std::int64_t seq, std::int64_t now);

  /// To be published at once, and every kRepeat_us until answered() or expired().
  [[nodiscard]] const experiment_command_t& message() const { return message_; }

  /// @return whether this request has been answered, by this status or an earlier one
  bool take(const experiment_status_t& status);

  [[nodiscard]] bool answered() const { return answered_; }

  /// Why the request was refused, once it is answered; empty if it was accepted.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }

  /// Whether no answer came within kTimeout_us.
  [[nodiscard]] bool expired(std::int64_t now) const {
    return !answered_ && now - message_.utime > kTimeout_us;
  }

 private:
  experiment_command_t message_;
  bool answered_ = false;
  std::string refusal_;
};

}  // namespace lab
