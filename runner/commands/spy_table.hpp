/// The table of `lab spy`. Independent of bus, clock and terminal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <lab/link_status_t.hpp>
#include <map>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/stream_counter.hpp"

namespace lab::runner {

/// Every stream of a bus. Its memory is bounded, whatever others publish.
class SpyTable {
 public:
  static constexpr std::size_t kMostHosts = 100;  ///< whose links are shown, and peers of each

  void take(const Packet& packet);

  /// The lines of the table, with the rates since the previous call.
  /// @param interval the time since then [s]
  /// @param now [us since 1970]
  [[nodiscard]] std::string text(double interval, std::int64_t now);

  /// The number of streams that are kept.
  [[nodiscard]] std::size_t size() const { return heard_.size(); }

 private:
  /// Of one stream, beside its counts.
  struct Heard {
    std::string type;
    std::int64_t received_at_last_show = 0;
    std::int64_t bytes = 0;
    std::int64_t last_received_utime = 0;
  };

  void takeLink(const Packet& packet);
  void forgetReplaced();
  [[nodiscard]] std::string linksText() const;

  StreamCounter counter_;
  std::map<StreamKey, Heard> heard_;            ///< streams that counter_ has, and some it had
  std::map<std::string, link_status_t> links_;  ///< by reporting host
};

}  // namespace lab::runner
