/// Whether a log speaks this software's contract.
#pragma once

#include <cstdint>
#include <lab/experiment_event_t.hpp>
#include <lab/service_status_t.hpp>
#include <map>
#include <string>
#include <string_view>

namespace lab::report {

/// Collects what a log says about its contract, and objects once all is read. A stray message of
/// another type is a decode error; a channel on which nothing is of its type is another contract.
class ContractCheck {
 public:
  /// Notes a message's type. @return whether it is the one that travels on this channel; true on
  /// channels that are not the lab's.
  bool accept(std::string_view channel, std::int64_t fingerprint);

  void take(const experiment_event_t& start);
  void take(const service_status_t& status);

  /// @throws ReportError naming the version or the type hash that is not known.
  void judge(const std::string& log_name) const;

 private:
  struct Channel {
    std::int64_t accepted = 0;
    std::int64_t foreign_hash = 0;
  };

  std::map<std::string, Channel, std::less<>> channels_;
  int contract_ = 0;     ///< 0: not said
  std::string version_;  ///< of the software that wrote the log
  std::string fingerprints_;
};

/// Whether the channel is one of the lab's.
[[nodiscard]] bool isLabChannel(std::string_view channel);

}  // namespace lab::report
