#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/service/experiment_request.hpp"
#include "common/service/node.hpp"
#include "common/text/printable.hpp"
#include "runner/commands/commands.hpp"
#include "runner/runs/lab_registry.hpp"

namespace lab::runner {
namespace {

/// Sends one request to one lab until it is answered.
class RequestSender {
 public:
  RequestSender(const RunningLab& lab, const std::string& name, const experiment_command_t& command)
      : bus_(lab.url),
        node_(bus_, loop_, {name, 0, loop_.now()}),
        request_(command, name, node_.identity().instance, 1, loop_.now()) {
    node_.subscribe<experiment_status_t>(channels::kExperimentStatus,
                                         [this](const experiment_status_t& status) {
                                           if (request_.take(status)) loop_.stop();
                                         });
  }

  const ExperimentRequest& execute() {
    loop_.onReadable(bus_.fileDescriptor(), [this] { bus_.drain(); });
    loop_.every(ExperimentRequest::kRepeat_us, loop_.now(), [this] {
      if (request_.expired(loop_.now())) {
        loop_.stop();
        return;
      }
      experiment_command_t message = request_.message();
      node_.publishCommand(channels::kExperimentCommand, message);
    });
    loop_.run();
    node_.close();
    return request_;
  }

 private:
  AsioLoop loop_;
  LcmBus bus_;
  Node node_;
  ExperimentRequest request_;
};

/// @param name of the sender in the record
/// @param done printed when the request was executed
ExitCode sendRequest(const RequestOptions& options, std::int8_t action, const std::string& name,
                     const std::string& done) {
  if (const std::string problem = remarkProblem(options.text); !problem.empty()) {
    throw UserError(problem);
  }
  experiment_command_t command{};
  command.action = action;
  command.text = options.text;
  const RunningLab lab = findLab(options.lab);
  RequestSender sender(lab, name, command);
  const ExperimentRequest& request = sender.execute();
  const std::string what = !request.answered()         ? "NOT confirmed: no answer"
                           : request.refusal().empty() ? done
                                                       : "refused: " + request.refusal();
  fmt::print("{}: {}\n", lab.name, printable(what));
  return request.answered() && request.refusal().empty() ? kDone : kFailed;
}

}  // namespace

ExitCode pauseScript(const RequestOptions& options) {
  return sendRequest(options, experiment_command_t::PAUSE, "lab_pause", "paused");
}

ExitCode resumeScript(const RequestOptions& options) {
  return sendRequest(options, experiment_command_t::RESUME, "lab_resume", "resumed");
}

ExitCode markRun(const RequestOptions& options) {
  return sendRequest(options, experiment_command_t::MARK, "lab_mark", "marked");
}

ExitCode endRun(const RequestOptions& options) {
  return sendRequest(options, experiment_command_t::END, "lab_end", "ending");
}

}  // namespace lab::runner
