// Datagrams of several sources, as the bus receives them: the first bytes of the network that the
// lab reads. Each has its source, the time since the one before, and its size in front.
#include <cstdint>
#include <numeric>
#include <optional>
#include <string_view>
#include <vector>

#include "common/bus/bus_error.hpp"
#include "common/bus/udpm_assembler.hpp"
#include "tests/fuzz/input.hpp"

namespace lab::fuzz {
namespace {

void assemble(Input& input) {
  constexpr unsigned kSources = 32;
  UdpmAssembler assembler([](std::string_view channel) { return channel != "UNWANTED"; });
  std::int64_t now = 946'684'800'000'000;
  while (!input.empty()) {
    const DatagramSource source{input.number<std::uint8_t>() % kSources, 7667};
    now += input.number<std::uint8_t>() * std::int64_t{10'000};
    const auto bytes = input.take(input.number<std::uint16_t>());
    // A copy of exactly this size: the sanitizers then notice one byte read too many.
    const std::vector<std::uint8_t> datagram(bytes.begin(), bytes.end());
    const std::optional<UdpmMessage> message = assembler.take(source, datagram, now);
    require(assembler.openMessages() <= UdpmAssembler::kMostOpen);
    require(assembler.openBytes() <= UdpmAssembler::kMostOpenBytes);
    if (!message) continue;
    require(message->channel.size() <= kLongestChannelName && message->channel != "UNWANTED");
    require(message->size <= UdpmAssembler::kLongestMessage);
    // Reads all of it.
    const std::uint8_t* data = message->data.get();
    require(std::accumulate(data, data + message->size, std::uint64_t{0}) <= 255 * message->size);
  }
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  lab::fuzz::Input input(bytes, size);
  lab::fuzz::assemble(input);
  return 0;
}
