#include "analyzer/log_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "analyzer/report/record/contract_check.hpp"
#include "analyzer/report_error.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/message_header.hpp"
#include "common/files/file_text.hpp"

namespace lab::report {
namespace fs = std::filesystem;
namespace {

constexpr const char* kLogInRun = "log.lcmlog";

fs::path logOf(const fs::path& run_or_log) {
  if (!fs::exists(run_or_log)) {
    throw ReportError(
        fmt::format("{}: no such file or folder; expected the folder of a run or a "
                    "log",
                    run_or_log.string()));
  }
  if (!fs::is_directory(run_or_log)) return run_or_log;
  const fs::path log = run_or_log / kLogInRun;
  if (!fs::exists(log)) {
    throw ReportError(fmt::format("{}: no {} in this folder; expected the folder of a run",
                                  run_or_log.string(), kLogInRun));
  }
  return log;
}

/// Thrown to stop reading a log early.
struct Enough {};

/// Decodes one message and passes it to its sink. @return whether it could be decoded.
template <class Message, class Sink>
bool deliver(Bytes data, const Sink& sink) {
  Message message{};
  if (!decode(data, message)) return false;
  sink(message);
  return true;
}

class Reading {
 public:
  explicit Reading(const MessageSinks& sinks) : sinks_(sinks) {}

  void take(const Packet& packet) {
    if (facts_.first_utime == 0) facts_.first_utime = packet.received_utime;
    facts_.last_utime = std::max(facts_.last_utime, packet.received_utime);
    if (!isLabChannel(packet.channel)) {
      ++facts_.other_channels[std::string(packet.channel)];
      return;
    }
    const std::optional<MessageHeader> header = peekHeader(packet.data);
    if (!header || !contract_.accept(packet.channel, header->fingerprint)) {
      ++facts_.decode_errors[std::string(packet.channel)];
      return;
    }
    loss_counter_.count(packet.channel, *header, packet.received_utime);
    if (!dispatch(packet)) ++facts_.decode_errors[std::string(packet.channel)];
  }

  LogFacts finish(const LogReadResult& read, const std::string& log_name) {
    contract_.judge(log_name);
    facts_.events = read.events;
    facts_.damaged_places = read.resyncs;
    facts_.streams = loss_counter_.streams();
    return std::move(facts_);
  }

 private:
  bool dispatch(const Packet& packet) {
    if (packet.channel == channels::kTrackedFrame) {
      ++facts_.frames;
      return deliver<tracked_frame_t>(packet.data, sinks_.frame);
    }
    if (packet.channel == channels::kRobotStatus) {
      return deliver<robot_status_t>(packet.data, sinks_.robots);
    }
    if (packet.channel == channels::kLightStatus) {
      return deliver<light_status_t>(packet.data, sinks_.light);
    }
    if (packet.channel == channels::kExperimentEvent) {
      return deliver<experiment_event_t>(packet.data, [this](const experiment_event_t& event) {
        if (event.kind == experiment_event_t::START) contract_.take(event);
        sinks_.event(event);
      });
    }
    if (packet.channel == channels::kServiceStatus) {
      return deliver<service_status_t>(packet.data, [this](const service_status_t& status) {
        contract_.take(status);
        loss_counter_.take(status);
        sinks_.service(status);
      });
    }
    if (packet.channel == channels::kLinkStatus) {
      return deliver<link_status_t>(packet.data, sinks_.link);
    }
    if (packet.channel == channels::kClock) facts_.virtual_time = true;
    return true;
  }

  const MessageSinks& sinks_;
  LogFacts facts_;
  MessageLossCounter loss_counter_;
  ContractCheck contract_;
};

}  // namespace

std::vector<fs::path> logFiles(const fs::path& run_or_log) {
  const fs::path log = logOf(run_or_log);
  std::vector<fs::path> files = logSeries(log);
  for (const fs::path& file : files) {
    const std::string problem = regularFileProblem(file, file_kinds::kLog);
    if (!problem.empty()) throw ReportError(file.string() + ": " + problem);
  }
  std::erase_if(files, [](const fs::path& file) { return fs::file_size(file) == 0; });
  if (files.empty()) {
    throw ReportError(log.string() +
                      ": the log is empty; nothing was recorded, so there is nothing to report");
  }
  if (!isLog(files.front())) {
    throw ReportError(log.string() +
                      ": this is not an LCM log; expected a file that lcm-logger or lab run wrote");
  }
  return files;
}

std::optional<experiment_event_t> findStart(const std::vector<fs::path>& files) {
  std::optional<experiment_event_t> start;
  try {
    readLog(files, [&start](const Packet& packet) {
      experiment_event_t event{};
      if (packet.channel != channels::kExperimentEvent || !decode(packet.data, event)) return;
      if (event.kind != experiment_event_t::START) return;
      start = std::move(event);
      throw Enough{};
    });
  } catch (const Enough&) {
  }
  return start;
}

LogFacts readMessages(const std::vector<fs::path>& files, const MessageSinks& sinks) {
  Reading reading(sinks);
  const LogReadResult read = readLog(files, [&](const Packet& packet) { reading.take(packet); });
  return reading.finish(read, files.front().filename().string());
}

}  // namespace lab::report
