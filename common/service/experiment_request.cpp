#include "common/service/experiment_request.hpp"

#include <algorithm>
#include <utility>

#include "common/text/utf8.hpp"

namespace lab {
namespace {

/// Whether a text has control characters of ASCII or Latin-1 (C2 80 .. C2 9F), which a terminal
/// would execute.
bool hasControls(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x20 || byte == 0x7F) return true;
    const bool two = byte == 0xC2 && i + 1 < text.size();
    if (two && static_cast<unsigned char>(text[i + 1]) < 0xA0) return true;
  }
  return false;
}

std::size_t countCharacters(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char byte) { return (byte & 0xC0) != 0x80; }));
}

}  // namespace

std::string remarkProblem(std::string_view text) {
  // The test of the bytes (at most four per character) avoids counting the characters of a huge
  // text.
  if (text.size() > 4 * kLongestRemark || countCharacters(text) > kLongestRemark) {
    return "the text is longer than " + std::to_string(kLongestRemark) + " characters";
  }
  std::string valid(text);
  repairUtf8(valid);
  if (valid != text) return "the text is not UTF-8";
  if (hasControls(text)) return "the text has control characters; one line is allowed";
  return {};
}

ExperimentRequest::ExperimentRequest(experiment_command_t request, const std::string& sender,
                                     std::int64_t instance, std::int64_t seq, std::int64_t now)
    : message_(std::move(request)) {
  message_.utime = now;
  message_.sender = sender;
  message_.instance = instance;
  message_.seq = seq;
}

bool ExperimentRequest::take(const experiment_status_t& status) {
  if (!answered_ && status.commander == message_.sender &&
      status.command_instance == message_.instance && status.command_seq == message_.seq) {
    answered_ = true;
    refusal_ = status.refusal;
  }
  return answered_;
}

}  // namespace lab
