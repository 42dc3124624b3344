#include "common/service/node.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/message_header.hpp"
#include "common/math/units.hpp"
#include "common/process/version.hpp"
#include "common/text/printable.hpp"
#include "common/text/utf8.hpp"

namespace lab {
namespace {

constexpr std::int64_t kClosingMessages = 5;
constexpr std::size_t kLongestErrors = 1000;     // [bytes] of one heartbeat
constexpr std::size_t kMostWaitingErrors = 500;  // a flood of different errors must not fill memory

std::string hostName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

/// An error may contain texts of any length from other hosts.
std::string shortenedError(const std::string& what) {
  return std::string(utf8Prefix(what, kLongestErrors));
}

}  // namespace

Node::Node(Bus& bus, Loop& loop, NodeIdentity identity)
    : bus_(bus), loop_(loop), identity_(std::move(identity)), start_utime_(loop.now()) {}

void Node::start() {
  beat();
  loop_.every(units::kSecond_us, start_utime_ + units::kSecond_us, [this] {
    if (state_ != service_status_t::ENDED) beat();
  });
}

void Node::ready() {
  if (state_ == service_status_t::ENDED) return;
  state_ = service_status_t::READY;
  beat();
}

void Node::noteError(const std::string& what, std::string_view subject) {
  if (what.empty()) return;
  const std::string text = shortenedError(what);
  const auto same = std::find_if(errors_.begin(), errors_.end(), [&](const WaitingError& waiting) {
    return subject.empty() ? waiting.text == text : waiting.subject == subject;
  });
  if (same != errors_.end()) {
    same->text = text;
    return;
  }
  if (errors_.size() == kMostWaitingErrors) errors_.pop_back();
  errors_.push_back({text, std::string(subject)});
}

/// @return what the next heartbeat reports, empty if nothing is new
std::string Node::nextErrors() {
  std::string text = std::exchange(fault_, {});
  while (!errors_.empty() &&
         (text.empty() || text.size() + 2 + errors_.front().text.size() <= kLongestErrors)) {
    text += (text.empty() ? "" : "; ") + errors_.front().text;
    errors_.pop_front();
  }
  return text;
}

void Node::fault(const std::string& what) {
  fault_ = shortenedError(what);
  if (state_ == service_status_t::FAULT || state_ == service_status_t::ENDED) return;
  state_ = service_status_t::FAULT;
  beat();
}

void Node::close() {
  if (state_ == service_status_t::ENDED) return;
  state_ = service_status_t::ENDED;
  for (remaining_closing_reports_ = kClosingMessages; remaining_closing_reports_ > 0;
       --remaining_closing_reports_)
    beat();
}

std::string_view Node::countedName(std::string_view sender) {
  return utf8Prefix(sender, kLongestSender);
}

void Node::refuse(std::string_view channel, std::string_view sender, const std::string& problem,
                  std::int64_t count) {
  streams_.countDecodeError(channel, count);
  // Once for each channel: a flood must not hide what else is reported.
  if (!refused_on_.emplace(channel).second) return;
  noteError(
      printable(std::string(channel) + " from " + std::string(sender) + " refused: " + problem));
}

void Node::refuseWithoutHeader(const Packet& packet) {
  if (const std::optional<LongSender> sender = peekLongSender(packet.data)) {
    refuse(packet.channel, sender->begin, sender->problem, 1);
  } else {
    streams_.countDecodeError(packet.channel);
  }
}

void Node::noteStreamLimit() {
  if (std::exchange(stream_limit_noted_, true)) return;
  noteError("more than " + std::to_string(StreamCounter::kMostStreams) +
            " streams of messages: the losses of further senders are not counted; end the programs "
            "that do not belong to this lab, or give it a port of its own");
}

std::string Node::lateOrEarly(std::int64_t utime, std::int64_t now) {
  return "utime: found " + std::to_string(utime) + ", " +
         std::to_string((utime - now) / units::kSecond_us) +
         " s from this host's clock, expected the time of the messages before it";
}

std::int64_t& Node::sentOn(std::string_view channel) {
  const auto found = sent_.find(channel);
  return found != sent_.end() ? found->second : sent_[std::string(channel)];
}

void Node::beat() {
  service_status_t status{};
  status.state = state_;
  status.origin = identity_.origin;
  if (!loop_.isVirtual()) {
    status.host = hostName();
    status.pid = getpid();
  }
  status.version = kVersion;
  status.contract_version = kContractVersion;
  status.start_utime = start_utime_;
  if (std::string errors = nextErrors(); !errors.empty()) last_error_ = std::move(errors);
  status.last_error = last_error_.c_str();  // LCM strings end at the first zero byte

  // The counts include this message, and in closing messages those still to be sent.
  const std::int64_t own = std::max<std::int64_t>(1, remaining_closing_reports_);
  auto sent = sent_;
  sent[std::string(channels::kServiceStatus)] += own;
  for (const auto& [channel, messages] : sent) {
    channel_count_t count{};
    count.channel = channel;
    count.messages = messages;
    status.sent.push_back(count);
  }
  status.num_sent = static_cast<std::int32_t>(status.sent.size());

  for (const auto& [key, stream] : streams_.streams()) {
    stream_count_t count{};
    count.channel = key.channel;
    count.sender = key.sender;
    count.instance = key.instance;
    count.received = stream.received;
    count.lost = stream.lost;
    status.received.push_back(count);
  }
  for (const auto& [channel, errors] : streams_.decodeErrors()) {
    stream_count_t count{};
    count.channel = channel;
    count.decode_errors = errors;
    status.received.push_back(count);
  }
  status.received.insert(status.received.end(), other_streams_.begin(), other_streams_.end());
  if (bus_rows_) {
    const std::vector<stream_count_t> rows = bus_rows_();
    status.received.insert(status.received.end(), rows.begin(), rows.end());
  }
  status.num_received = static_cast<std::int32_t>(status.received.size());
  publish(channels::kServiceStatus, status);
}

}  // namespace lab
