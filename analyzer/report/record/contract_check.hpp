/// Checks whether a log was written under this software's message contract.
#pragma once

#include <cstdint>
#include <lab/experiment_event_t.hpp>
#include <lab/service_status_t.hpp>
#include <map>
#include <string>
#include <string_view>

namespace lab::report {

/// Collects the contract version and the message types of a log, and judges them at the end. A
/// single message of another type is a decode error. A channel on which no message has its type
/// indicates another contract.
class ContractCheck {
 public:
  /// Records the type of a message. @return whether it is the type of this channel; true on
  /// channels that are not the lab's.
  bool accept(std::string_view channel, std::int64_t fingerprint);

  void take(const experiment_event_t& start);
  void take(const service_status_t& status);

  /// The first type in a START's list of fingerprints that is not this software's; empty: none.
  [[nodiscard]] static std::string changedType(const std::string& fingerprints);

  /// @throws ReportError with the unknown version or type hash.
  void judge(const std::string& log_name) const;

 private:
  struct Channel {
    std::int64_t accepted = 0;
    std::int64_t foreign_hash = 0;
  };

  std::map<std::string, Channel, std::less<>> channels_;
  int contract_ = 0;     ///< 0: not stated
  std::string version_;  ///< of the software that wrote the log
  std::string fingerprints_;
};

/// Whether the channel is one of the lab's.
[[nodiscard]] bool isLabChannel(std::string_view channel);

}  // namespace lab::report
