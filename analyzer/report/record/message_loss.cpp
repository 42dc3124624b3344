#include "analyzer/report/record/message_loss.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <tuple>

#include "common/bus/stream_counter.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/math/saturated.hpp"
#include "common/math/units.hpp"

namespace lab::report {

namespace {

constexpr std::size_t kMostStreams = 64;           // of one sender: the lab has 21 channels
constexpr std::int64_t kNearSeq = 1000;            // between two messages of a stream
constexpr std::int64_t kFarthestSeq = 10'000'000;  // of a count beyond the messages in the log

bool isNear(std::int64_t seq, std::int64_t other) {
  const std::int64_t difference = saturatedDifference(seq, other);
  return difference >= -kNearSeq && difference <= kNearSeq;
}

}  // namespace

LossTotal totalOf(const std::vector<StreamLoss>& streams) {
  LossTotal total;
  for (const StreamLoss& stream : streams) {
    total.received += stream.received;
    total.lost += stream.lost;
    total.at_least = total.at_least || (stream.at_least && stream.sender != kObserverService);
  }
  return total;
}

MessageLossCounter::Sender* MessageLossCounter::sender(std::string_view name,
                                                       std::int64_t instance) {
  const auto found = std::find_if(senders_.begin(), senders_.end(), [&](const Sender& one) {
    return one.instance == instance && one.name == name;
  });
  if (found != senders_.end()) return &*found;
  if (senders_.size() >= kMostSenders) return nullptr;
  senders_.push_back({std::string(name), instance, 0, false, false, {}});
  return &senders_.back();
}

MessageLossCounter::Stream* MessageLossCounter::Sender::stream(std::string_view channel) {
  const auto found = std::find_if(streams.begin(), streams.end(),
                                  [&](const Stream& one) { return one.channel == channel; });
  if (found != streams.end()) return &*found;
  if (streams.size() >= kMostStreams) return nullptr;
  streams.emplace_back().channel = channel;
  return &streams.back();
}

void MessageLossCounter::count(std::string_view channel, const MessageHeader& header,
                               std::int64_t received_utime) {
  if (first_utime_ == 0) first_utime_ = received_utime;
  Sender* const from = sender(header.sender, header.instance);
  Stream* const found = from != nullptr ? from->stream(channel) : nullptr;
  if (found == nullptr) {
    ++uncounted_;
    return;
  }
  Stream& stream = *found;
  stream.take(header.seq);
  stream.largest_age_us =
      std::max(stream.largest_age_us, saturatedDifference(received_utime, header.utime));
}

void MessageLossCounter::Stream::take(std::int64_t seq) {
  const auto near = [seq](std::int64_t other) { return isNear(seq, other); };
  ++received;
  if (received > 1 && !near(last_seq)) {
    // A damaged number would be the largest or the smallest for ever: the next one must confirm it.
    if (!doubt || !near(*doubt)) {
      doubt = seq;
      return;
    }
    if (numbered == 1) numbered = 0;  // the first one was damaged
  }
  doubt.reset();
  if (numbered++ == 0) first_seq = last_seq = seq;
  first_seq = std::min(first_seq, seq);
  last_seq = std::max(last_seq, seq);
}

void MessageLossCounter::take(const service_status_t& status) {
  Sender* const known = sender(status.sender, status.instance);
  if (known == nullptr) return;
  Sender& from = *known;
  from.start_utime = status.start_utime;
  from.ended = from.ended || status.state == service_status_t::ENDED;
  for (const channel_count_t& count : status.sent) {
    Stream* const found = from.stream(count.channel);
    if (found == nullptr) continue;
    Stream& stream = *found;
    if (count.messages - std::max(stream.last_seq, stream.sent_last) > kFarthestSeq) continue;
    if (!from.has_status) {
      stream.sent_first = count.messages;
      stream.received_first = stream.received;
    }
    stream.sent_last = std::max(stream.sent_last, count.messages);
  }
  from.has_status = true;
}

StreamLoss MessageLossCounter::loss(const Sender& sender, const Stream& stream) const {
  const bool seq_counts = seqCountsMessages(stream.channel);
  const bool started_before = !sender.has_status || sender.start_utime < first_utime_;
  // Messages sent before the log began: at most the count of the first status, and only those
  // before the first message in the log.
  std::int64_t before = 0;
  if (started_before && seq_counts && stream.received > 0) {
    before = stream.first_seq - 1;
    if (sender.has_status) before = std::min(before, stream.sent_first);
  } else if (started_before) {
    before = stream.sent_first - stream.received_first;
  }
  const std::int64_t sent =
      seq_counts ? std::max(stream.sent_last, stream.last_seq) : stream.sent_last;
  StreamLoss loss;
  loss.channel = stream.channel;
  loss.sender = sender.name;
  loss.start = startOf(sender.name, sender.instance);
  loss.received = stream.received;
  loss.lost = std::max<std::int64_t>(0, sent - before - stream.received);
  loss.at_least = !sender.ended;
  loss.largest_age = units::seconds(stream.largest_age_us);
  return loss;
}

int MessageLossCounter::startOf(std::string_view sender, std::int64_t instance) const {
  int start = 0;
  for (const Sender& one : senders_) {
    if (one.name != sender) continue;
    ++start;
    if (one.instance == instance) return start;
  }
  return 0;
}

std::vector<StreamLoss> MessageLossCounter::streams() const {
  std::vector<StreamLoss> losses;
  for (const Sender& sender : senders_) {
    for (const Stream& stream : sender.streams) losses.push_back(loss(sender, stream));
  }
  std::sort(losses.begin(), losses.end(), [](const StreamLoss& a, const StreamLoss& b) {
    return std::tie(a.sender, a.start, a.channel) < std::tie(b.sender, b.start, b.channel);
  });
  return losses;
}

}  // namespace lab::report
