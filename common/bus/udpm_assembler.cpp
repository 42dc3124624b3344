#include "common/bus/udpm_assembler.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>

#include "common/bus/bus_error.hpp"

namespace lab {
namespace {

constexpr std::uint32_t kWhole = 0x4c433032;     // "LC02"
constexpr std::uint32_t kFragment = 0x4c433033;  // "LC03"
constexpr std::size_t kWholeHeader = 8;          // [byte]
constexpr std::size_t kFragmentHeader = 20;      // [byte]

std::uint32_t number32(Bytes bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) << 24 |
         static_cast<std::uint32_t>(bytes[at + 1]) << 16 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 8 | bytes[at + 3];
}

std::uint16_t number16(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

/// The channel at the beginning of `bytes`; nothing if no 0 ends it in time.
std::optional<std::string_view> channelIn(Bytes bytes) {
  const std::size_t most = std::min(bytes.size(), kLongestChannelName + 1);
  const auto end = std::find(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(most), 0);
  const auto size = static_cast<std::size_t>(end - bytes.begin());
  if (size == most) return std::nullopt;
  return std::string_view(reinterpret_cast<const char*>(bytes.data()), size);
}

/// Adds [begin, end) to the disjoint intervals in `pieces` and joins neighbours.
/// @return false, and changes nothing, if part of it is already there
bool addPiece(std::map<std::uint32_t, std::uint32_t>& pieces, std::uint32_t begin,
              std::uint32_t end) {
  auto next = pieces.lower_bound(begin);
  if (next != pieces.end() && next->first < end) return false;
  if (next != pieces.end() && next->first == end) end = next->second;
  auto piece = pieces.end();
  if (next != pieces.begin()) {
    const auto before = std::prev(next);
    if (before->second > begin) return false;
    if (before->second == begin) piece = before;
  }
  if (next != pieces.end() && next->second == end) pieces.erase(next);
  if (piece != pieces.end()) {
    piece->second = end;
  } else {
    pieces.emplace(begin, end);
  }
  return true;
}

}  // namespace

std::optional<UdpmMessage> UdpmAssembler::take(const DatagramSource& source, Bytes datagram,
                                               std::int64_t utime) {
  while (!open_.empty() && utime - open_.front().message.received_utime > kLongestWait_us) {
    giveUp(open_.begin());
  }
  if (datagram.size() < kWholeHeader) return refuse(Refusal::kNotLcm, source);
  const std::uint32_t magic = number32(datagram, 0);
  if (magic == kWhole) return takeWhole(source, datagram.subspan(kWholeHeader), utime);
  if (magic != kFragment || datagram.size() < kFragmentHeader) {
    return refuse(Refusal::kNotLcm, source);
  }
  const std::optional<Fragment> fragment = readFragment(source, datagram);
  if (!fragment) return std::nullopt;
  return takeFragment(source, *fragment, utime);
}

std::optional<UdpmMessage> UdpmAssembler::takeWhole(const DatagramSource& source, Bytes content,
                                                    std::int64_t utime) {
  const std::optional<std::string_view> channel = channelIn(content);
  if (!channel) return refuse(Refusal::kBadChannel, source);
  if (!wants_(*channel)) return std::nullopt;
  const Bytes data = content.subspan(channel->size() + 1);
  UdpmMessage message{.channel = std::string(*channel),
                      .data = std::make_unique_for_overwrite<std::uint8_t[]>(data.size()),
                      .size = data.size(),
                      .received_utime = utime};
  std::copy(data.begin(), data.end(), message.data.get());
  return message;
}

std::optional<UdpmAssembler::Fragment> UdpmAssembler::readFragment(const DatagramSource& source,
                                                                   Bytes datagram) {
  Fragment fragment{.sequence = number32(datagram, 4),
                    .message_size = number32(datagram, 8),
                    .offset = number32(datagram, 12),
                    .number = number16(datagram, 16),
                    .fragments = number16(datagram, 18),
                    .data = datagram.subspan(kFragmentHeader),
                    .channel = {}};
  if (fragment.message_size > kLongestMessage) return refuse(Refusal::kTooLong, source);
  if (fragment.number >= fragment.fragments) return refuse(Refusal::kBadFragment, source);
  if (fragment.number == 0) {
    const std::optional<std::string_view> channel = channelIn(fragment.data);
    if (!channel) return refuse(Refusal::kBadChannel, source);
    fragment.channel = *channel;
    fragment.data = fragment.data.subspan(channel->size() + 1);
  }
  // A fragment without data belongs to nothing but an empty message.
  const bool misses = fragment.data.empty() && fragment.message_size > 0;
  // Without addition, which could exceed 32 bits.
  if (misses || fragment.offset > fragment.message_size ||
      fragment.data.size() > fragment.message_size - fragment.offset) {
    return refuse(Refusal::kBadFragment, source);
  }
  return fragment;
}

std::optional<UdpmMessage> UdpmAssembler::takeFragment(const DatagramSource& source,
                                                       const Fragment& fragment,
                                                       std::int64_t utime) {
  const auto open = openFor(source, fragment);
  const auto size = static_cast<std::uint32_t>(fragment.data.size());
  if (size > 0 && !addPiece(open->pieces, fragment.offset, fragment.offset + size)) {
    return refuse(Refusal::kBadFragment, source);
  }
  if (fragment.number == 0) {
    open->message.channel = fragment.channel;
    open->has_channel = true;
  }
  std::copy(fragment.data.begin(), fragment.data.end(), open->message.data.get() + fragment.offset);
  open->message.received_utime = utime;
  open_.splice(open_.end(), open_, open);
  if (open->pieces.size() > kMostGaps) {
    giveUp(open);
    return std::nullopt;
  }
  const bool complete =
      open->size == 0 || (open->pieces.size() == 1 && open->pieces.begin()->first == 0 &&
                          open->pieces.begin()->second == open->size);
  if (!complete || !open->has_channel) return std::nullopt;
  UdpmMessage message = std::move(open->message);
  remove(open);
  if (!wants_(message.channel)) return std::nullopt;
  return message;
}

UdpmAssembler::OpenMessages::iterator UdpmAssembler::openFor(const DatagramSource& source,
                                                             const Fragment& fragment) {
  const auto found = std::find_if(open_.begin(), open_.end(), [&](const Open& open) {
    return open.source == source && open.sequence == fragment.sequence;
  });
  if (found != open_.end()) {
    if (found->size == fragment.message_size && found->fragments == fragment.fragments) {
      return found;
    }
    giveUp(found);  // another process has the sender's port now and counts from 0 again
  }
  makeRoom(source, fragment.message_size);
  open_.push_back(
      {.source = source,
       .sequence = fragment.sequence,
       .size = fragment.message_size,
       .fragments = fragment.fragments,
       .message = {.channel = {},
                   .data = std::make_unique_for_overwrite<std::uint8_t[]>(fragment.message_size),
                   .size = fragment.message_size},
       .pieces = {}});
  open_bytes_ += fragment.message_size;
  return std::prev(open_.end());
}

void UdpmAssembler::makeRoom(const DatagramSource& source, std::size_t bytes) {
  const auto is_of_source = [&source](const Open& open) { return open.source == source; };
  const auto of_source = std::count_if(open_.begin(), open_.end(), is_of_source);
  if (static_cast<std::size_t>(of_source) >= kMostOpenOfOneSource) {
    giveUp(std::find_if(open_.begin(), open_.end(), is_of_source));
  }
  while (!open_.empty() && (open_.size() >= kMostOpen || open_bytes_ + bytes > kMostOpenBytes)) {
    giveUp(open_.begin());
  }
}

void UdpmAssembler::giveUp(OpenMessages::iterator open) {
  refused_.count(Refusal::kIncomplete, open->source);
  remove(open);
}

void UdpmAssembler::remove(OpenMessages::iterator open) {
  open_bytes_ -= open->size;
  open_.erase(open);
}

std::nullopt_t UdpmAssembler::refuse(Refusal reason, const DatagramSource& source) {
  refused_.count(reason, source);
  return std::nullopt;
}

}  // namespace lab
