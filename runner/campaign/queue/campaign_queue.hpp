/// Campaigns that wait for the lab. Pure functions on the text of the queue's file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab::runner::campaign {

/// One campaign of the queue: a command line of `lab sweep`.
struct QueuedCampaign {
  enum class State { kWaiting, kRunning, kDone, kFailed };
  std::int64_t number = 0;             ///< for `lab queue remove`; never used again
  std::vector<std::string> arguments;  ///< of lab sweep
  std::string folder;                  ///< where it was added: paths are relative to it
  State state = State::kWaiting;
  std::int64_t begin_us = 0;  ///< UTC [us]; 0: it has not begun
  std::int64_t end_us = 0;    ///< UTC [us]; 0: it has not ended
  int exit_code = 0;

  bool operator==(const QueuedCampaign&) const = default;
};

[[nodiscard]] const char* nameOf(QueuedCampaign::State state);

/// @throws UserError if it is not what queueText() writes
/// @param name of the file, for the message
[[nodiscard]] std::vector<QueuedCampaign> readQueue(std::string_view text, const std::string& name);

[[nodiscard]] std::string queueText(const std::vector<QueuedCampaign>& queue);

/// The campaign that is run next: one that was interrupted, else the first that waits.
[[nodiscard]] std::optional<std::size_t> nextOf(const std::vector<QueuedCampaign>& queue);

/// A line of `lab queue`.
[[nodiscard]] std::string lineOf(const QueuedCampaign& campaign);

}  // namespace lab::runner::campaign
