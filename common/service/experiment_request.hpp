/// A wish towards a running experiment or a played log (EXPERIMENT_COMMAND), until it is answered.
#pragma once

#include <cstddef>
#include <cstdint>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <string>
#include <string_view>

namespace lab {

/// Characters of a remark and of a reason, at most.
inline constexpr std::size_t kLongestRemark = 500;

/// Why a text is no remark for the record, empty: it is one. UTF-8 without control characters.
[[nodiscard]] std::string remarkProblem(std::string_view text);

/// One wish, repeated until EXPERIMENT_STATUS echoes it: no bus, no clock. Times are us since 1970.
class ExperimentRequest {
 public:
  static constexpr std::int64_t kRepeat_us = 200'000;  // 5 Hz
  static constexpr std::int64_t kTimeout_us = 5'000'000;

  /// @param wish action, value and text
  /// @param sender, instance of the node that publishes it
  /// @param seq another one for each wish of this node
  ExperimentRequest(experiment_command_t wish, const std::string& sender, std::int64_t instance,
                    std::int64_t seq, std::int64_t now);

  /// To be published now and at kRepeat_us until answered() or expired().
  [[nodiscard]] const experiment_command_t& message() const { return message_; }

  /// @return whether this wish has been answered, by this status or before.
  bool take(const experiment_status_t& status);

  [[nodiscard]] bool answered() const { return answered_; }

  /// Why it was not obeyed, once it is answered; empty: it was.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }

  /// Nobody has answered for so long that nobody will.
  [[nodiscard]] bool expired(std::int64_t now) const {
    return !answered_ && now - message_.utime > kTimeout_us;
  }

 private:
  experiment_command_t message_;
  bool answered_ = false;
  std::string refusal_;
};

}  // namespace lab
