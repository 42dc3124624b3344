#include "runner/live/request_log.hpp"

#include <algorithm>
#include <utility>

#include "common/service/experiment_request.hpp"

namespace lab::runner {
namespace {

// More than the requests that are repeated at one time: each is repeated for a few seconds.
constexpr std::size_t kAnswersKept = 256;
constexpr std::size_t kLongestName = 64;  // bytes

bool hasName(const experiment_command_t& command) {
  return !command.sender.empty() && command.sender.size() <= kLongestName &&
         remarkProblem(command.sender).empty();
}

}  // namespace

void RequestLog::take(const experiment_command_t& command) {
  const auto known = std::ranges::find_if(answers_, [&command](const Answer& answer) {
    return answer.seq == command.seq && answer.instance == command.instance &&
           answer.sender == command.sender;
  });
  Answer answer;
  if (known != answers_.end()) {
    answer = std::move(*known);
    answers_.erase(known);
  } else {
    std::string refusal =
        hasName(command) ? remarkProblem(command.text) : "the request has no sender name";
    if (refusal.empty()) refusal = handler_(command);
    answer = {command.sender, command.instance, command.seq, std::move(refusal)};
  }
  answers_.push_back(std::move(answer));
  if (answers_.size() > kAnswersKept) answers_.pop_front();
}

void RequestLog::write(experiment_status_t& status) const {
  if (answers_.empty()) return;
  const Answer& last = answers_.back();
  status.commander = last.sender;
  status.command_instance = last.instance;
  status.command_seq = last.seq;
  status.refusal = last.refusal;
}

}  // namespace lab::runner
