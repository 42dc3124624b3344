/// Logs with damaged, forged, doubled and missing messages. The same seed gives the same damage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lab {

struct RecordedMessage {
  std::string channel;
  std::vector<std::uint8_t> data;
  std::int64_t utime = 0;
};

/// All messages of a log.
[[nodiscard]] std::vector<RecordedMessage> recordedMessages(const std::filesystem::path& log);

/// The messages with one to eight faults: flipped bits, numbers overwritten with extreme ones,
/// doubled, lost, swapped and truncated messages, forged senders, times of other years.
[[nodiscard]] std::vector<RecordedMessage> mutated(std::vector<RecordedMessage> messages,
                                                   std::uint64_t seed);

/// The message with one to four faults: flipped bits, extreme numbers, a forged sender, a time of
/// another year, or cut off.
[[nodiscard]] RecordedMessage mutant(RecordedMessage message, std::uint64_t seed);

/// Sets the time in the header of a message.
void setUtime(RecordedMessage& message, std::int64_t utime);

/// One message with extreme numbers written over its own.
void overwriteNumbers(std::vector<std::uint8_t>& data, std::uint64_t seed);

/// The bytes of a log file with these messages; for some seeds with bits flipped in the file, or
/// cut off.
[[nodiscard]] std::string logBytes(const std::vector<RecordedMessage>& messages,
                                   std::uint64_t seed);

/// Names the mutant on stderr if the process crashes, or if it takes longer than a minute.
class MutantWatch {
 public:
  explicit MutantWatch(std::uint64_t seed);
  ~MutantWatch();
  MutantWatch(const MutantWatch&) = delete;
  MutantWatch& operator=(const MutantWatch&) = delete;
};

/// How many mutants a test tries: LAB_MUTANTS, or `usual`; the first seed is LAB_MUTANT, or 1.
struct MutantRange {
  std::uint64_t first = 1;
  std::uint64_t count = 0;
};
[[nodiscard]] MutantRange mutants(std::uint64_t usual);

/// Calls `mutant` with every seed of the range. A thousand mutants or more are tried in child
/// processes, one for each core, and their rate is printed; a child with a failed assertion, or one
/// that crashes, fails the test.
/// @param mutant returns whether this mutant counts
/// @return the number of mutants that count
std::uint64_t forEachMutant(const MutantRange& range,
                            const std::function<bool(std::uint64_t seed)>& mutant);

}  // namespace lab
