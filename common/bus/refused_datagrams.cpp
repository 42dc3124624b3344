#include "common/bus/refused_datagrams.hpp"

namespace lab {
namespace {

/// Whether datagrams were good but had no room: these are losses, the others are errors.
bool isLoss(Refusal reason) {
  return reason == Refusal::kIncomplete || reason == Refusal::kQueueFull ||
         reason == Refusal::kReceiveBuffer;
}

}  // namespace

std::string sourceText(const DatagramSource& source) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) {
    text += std::to_string(source.address >> shift & 0xff) + (shift > 0 ? "." : ":");
  }
  return text + std::to_string(source.port);
}

std::string_view refusalText(Refusal reason) {
  switch (reason) {
    case Refusal::kStranger:
      return "source is not this machine";
    case Refusal::kUnicast:
      return "not sent to the group";
    case Refusal::kNotLcm:
      return "not an LCM datagram";
    case Refusal::kBadChannel:
      return "bad channel name";
    case Refusal::kBadFragment:
      return "fragment outside of its message, or repeated";
    case Refusal::kTooLong:
      return "message is too long";
    case Refusal::kIncomplete:
      return "message is incomplete";
    case Refusal::kQueueFull:
      return "queue of this process is full";
    case Refusal::kReceiveBuffer:
      return "receive buffer of the socket was full";
  }
  return "";
}

void RefusedDatagrams::count(Refusal reason, const DatagramSource& source, std::int64_t datagrams) {
  Count& count = counts_[static_cast<std::size_t>(reason)];
  count.datagrams += datagrams;
  count.last = source;
}

void RefusedDatagrams::add(const RefusedDatagrams& other) {
  for (std::size_t i = 0; i < kRefusals; ++i) {
    const auto reason = static_cast<Refusal>(i);
    const Count& more = other.of(reason);
    if (more.datagrams > 0) count(reason, more.last, more.datagrams);
  }
}

std::vector<std::string> RefusedDatagrams::linesSince(const RefusedDatagrams& before) const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < kRefusals; ++i) {
    const auto reason = static_cast<Refusal>(i);
    const std::int64_t more = of(reason).datagrams - before.of(reason).datagrams;
    if (more <= 0) continue;
    lines.push_back((isLoss(reason) ? "the bus lost " : "the bus refused ") + std::to_string(more) +
                    ": " + std::string(refusalText(reason)) + ", the last from " +
                    sourceText(of(reason).last) + "; " + std::to_string(of(reason).datagrams) +
                    " since the start");
  }
  return lines;
}

std::vector<stream_count_t> RefusedDatagrams::rows() const {
  std::vector<stream_count_t> rows;
  for (std::size_t i = 0; i < kRefusals; ++i) {
    const auto reason = static_cast<Refusal>(i);
    const Count& count = of(reason);
    if (count.datagrams == 0) continue;
    stream_count_t row{};
    row.channel = "bus";
    row.sender = std::string(refusalText(reason)) + ", last " + sourceText(count.last);
    (isLoss(reason) ? row.lost : row.decode_errors) = count.datagrams;
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace lab
