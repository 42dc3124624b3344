#include "analyzer/log_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "analyzer/report/record/contract_check.hpp"
#include "analyzer/report_error.hpp"
#include "common/bus/arrival_clock.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/message_header.hpp"
#include "common/bus/message_values.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/files/file_text.hpp"
#include "common/math/units.hpp"
#include "common/process/version.hpp"

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

constexpr std::int64_t kRunnerSilent_us = 3'000'000;  // a runner sends five messages a second

/// Thrown to stop reading a log early.
struct Enough {};

/// Ranks the copies of a START event, because each is sent several times and one copy may be
/// damaged. An undamaged START has a contract version that exists, the message types of this
/// software, and an experiment. The rank is 1 plus the number of these that are right, counted up
/// to the first wrong one.
class StartJudge {
 public:
  static constexpr int kWhole = 4;

  int rankOf(const experiment_event_t& start) {
    if (start.contract_version < kOldestContractVersion ||
        start.contract_version > kContractVersion) {
      return 1;
    }
    if (!ContractCheck::changedType(start.fingerprints).empty()) return 2;
    return isExperiment(start.text) ? kWhole : 3;
  }

 private:
  /// Parses each text once, because a log may repeat the same text thousands of times.
  bool isExperiment(const std::string& text) {
    constexpr std::size_t kMostTexts = 1000;
    if (const auto known = texts_.find(text); known != texts_.end()) return known->second;
    if (texts_.size() >= kMostTexts) texts_.clear();
    bool parses = true;
    try {
      static_cast<void>(parseExperiment(text, "experiment in the log"));
    } catch (const ExperimentError&) {
      parses = false;
    }
    return texts_[text] = parses;
  }

  std::map<std::string, bool> texts_;  ///< whether it is an experiment
};

/// Passes the messages of a log to the sinks, and collects the facts about the log.
class Reading {
 public:
  /// @param start the START event of the run, if the log has one
  Reading(const MessageSinks& sinks, const std::optional<experiment_event_t>& start)
      : sinks_(sinks) {
    if (!start) return;
    runner_ = {start->sender, start->instance};
    contract_.take(*start);
  }

  void take(const Packet& packet) {
    if (facts_.first_utime == 0) facts_.first_utime = packet.received_utime;
    facts_.last_utime = std::max(facts_.last_utime, packet.received_utime);
    if (!isLabChannel(packet.channel)) {
      countOther(packet.channel);
      return;
    }
    const std::optional<MessageHeader> header = peekHeader(packet.data);
    if (!header || !contract_.accept(packet.channel, header->fingerprint)) {
      ++facts_.decode_errors[std::string(packet.channel)];
      return;
    }
    if (const auto problem = impossibleHeader(packet.channel, header->utime, header->seq)) {
      refuse(packet.channel, header->sender, *problem);
      return;
    }
    loss_counter_.count(packet.channel, *header, packet.received_utime);
    if (isRunner(*header)) runner_utime_ = packet.received_utime;
    if (!dispatch(packet)) ++facts_.decode_errors[std::string(packet.channel)];
  }

  LogFacts finish(const LogReadResult& read, const std::string& log_name) {
    contract_.judge(log_name);
    facts_.events = read.events;
    facts_.damaged_places = read.resyncs;
    facts_.bad_times = read.bad_times;
    facts_.streams = loss_counter_.streams();
    facts_.foreign_senders = loss_counter_.uncounted();
    return std::move(facts_);
  }

 private:
  /// Decodes one message. Passes it to the sink, unless a number in it is impossible or its time
  /// does not fit the messages before it. @return whether it could be decoded.
  template <class Message, class Sink>
  bool deliver(const Packet& packet, const Sink& sink) {
    Message message{};
    if (!decode(packet.data, message)) return false;
    if (const auto found = removeImpossible(message)) {
      if (!found->usable) {
        refuse(packet.channel, message.sender, found->first);
        return true;
      }
      removeRobots(packet.channel, message.sender, *found);
    }
    const bool timely = !timesFollowClock(packet.channel) ||
                        clocks_[std::string(packet.channel)].accepts(
                            message.sender, message.instance, message.utime, packet.received_utime);
    if (!timely) {
      refuse(packet.channel, message.sender,
             fmt::format("utime: found {}, {:.1f} s from its arrival, expected the time of the "
                         "messages before it",
                         message.utime, units::seconds(message.utime - packet.received_utime)));
      return true;
    }
    sink(message);
    return true;
  }

  bool dispatch(const Packet& packet) {
    if (packet.channel == channels::kTrackedFrame) {
      return deliver<tracked_frame_t>(packet, [this](const tracked_frame_t& frame) {
        ++facts_.frames;
        sinks_.frame(frame);
      });
    }
    if (packet.channel == channels::kRobotStatus) {
      return deliver<robot_status_t>(packet, sinks_.robots);
    }
    if (packet.channel == channels::kRobotCommand && sinks_.command) {
      robot_command_t command{};
      if (!decode(packet.data, command)) return false;
      sinks_.command(command);
      return true;
    }
    if (packet.channel == channels::kLightStatus) {
      return deliver<light_status_t>(packet, sinks_.light);
    }
    if (packet.channel == channels::kExperimentEvent) {
      return deliver<experiment_event_t>(packet, [this, &packet](const experiment_event_t& event) {
        take(event, packet.received_utime);
      });
    }
    if (packet.channel == channels::kServiceStatus) {
      return deliver<service_status_t>(packet, [this](const service_status_t& status) {
        contract_.take(status);
        loss_counter_.take(status);
        sinks_.service(status);
      });
    }
    if (packet.channel == channels::kLinkStatus) {
      return deliver<link_status_t>(packet, sinks_.link);
    }
    if (packet.channel == channels::kRobotSenses && sinks_.senses) {
      return deliver<robot_senses_t>(packet, sinks_.senses);
    }
    if (packet.channel == channels::kClock) facts_.virtual_time = true;
    return true;
  }

  /// Whether this START event begins another run, because a log that was recorded by hand may have
  /// several. Such an event is accepted after the END of the previous run, or when the runner of
  /// the previous run has sent nothing for kRunnerSilent_us.
  bool beginsNextRun(const experiment_event_t& event, std::int64_t received_utime) {
    return event.kind == experiment_event_t::START &&
           (ended_ || (runner_utime_ != 0 && received_utime - runner_utime_ > kRunnerSilent_us)) &&
           judge_.rankOf(event) == StartJudge::kWhole;
  }

  void take(const experiment_event_t& event, std::int64_t received_utime) {
    const std::pair sender{event.sender, event.instance};
    if (!runner_) runner_ = sender;
    if (*runner_ != sender && beginsNextRun(event, received_utime)) {
      runner_ = sender;
      ended_ = false;
    }
    if (*runner_ != sender) {
      refuse(channels::kExperimentEvent, event.sender,
             fmt::format("sender: found \"{}\" (instance {}), expected the runner \"{}\" "
                         "(instance {})",
                         event.sender, event.instance, runner_->first, runner_->second));
      return;
    }
    runner_utime_ = received_utime;
    ended_ = ended_ || event.kind == experiment_event_t::END;
    sinks_.event(event);
  }

  [[nodiscard]] bool isRunner(const MessageHeader& header) const {
    return runner_ && header.sender == runner_->first && header.instance == runner_->second;
  }

  void refuse(std::string_view channel, std::string_view sender, const std::string& problem) {
    ++refusedOn(channel, sender, problem).count;
  }

  void removeRobots(std::string_view channel, std::string_view sender,
                    const ImpossibleNumbers& found) {
    refusedOn(channel, sender, found.first).robots += found.count;
  }

  RefusedMessages& refusedOn(std::string_view channel, std::string_view sender,
                             const std::string& problem) {
    RefusedMessages& refused = facts_.refused[std::string(channel)];
    if (refused.first.empty()) refused.first = fmt::format("from {}: {}", sender, problem);
    return refused;
  }

  void countOther(std::string_view channel) {
    constexpr std::size_t kMostOthers = 100;
    std::string name(channel);
    if (facts_.other_channels.size() >= kMostOthers && !facts_.other_channels.contains(name)) {
      name = "further channels";
    }
    ++facts_.other_channels[name];
  }

  const MessageSinks& sinks_;
  LogFacts facts_;
  MessageLossCounter loss_counter_;
  ContractCheck contract_;
  std::map<std::string, ArrivalClock> clocks_;                  ///< by channel
  std::optional<std::pair<std::string, std::int64_t>> runner_;  ///< sender and instance
  std::int64_t runner_utime_ = 0;                               ///< arrival of its last message
  bool ended_ = false;  ///< the runner has reported the END of its run
  StartJudge judge_;
};

/// How to unpack the log if its name says that it is compressed.
std::string unpackHint(const fs::path& log) {
  for (const auto& [ending, program] : {std::pair(".xz", "xz"), std::pair(".gz", "gzip"),
                                        std::pair(".bz2", "bzip2"), std::pair(".zst", "zstd")}) {
    if (log.extension() == ending) {
      return fmt::format("; unpack it first: {} -dk {}", program, log.string());
    }
  }
  return {};
}

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
                      ": this is not an LCM log; expected a file that lcm-logger or lab run wrote" +
                      unpackHint(log));
  }
  return files;
}

std::optional<experiment_event_t> findStart(const std::vector<fs::path>& files) {
  std::optional<experiment_event_t> start;
  int rank = 0;
  StartJudge judge;
  try {
    readLog(files, [&](const Packet& packet) {
      experiment_event_t event{};
      if (packet.channel != channels::kExperimentEvent || !decode(packet.data, event)) return;
      if (event.kind != experiment_event_t::START || impossibleValue(event)) return;
      const int own = judge.rankOf(event);
      if (own <= rank) return;
      rank = own;
      start = std::move(event);
      if (rank == StartJudge::kWhole) throw Enough{};
    });
  } catch (const Enough&) {
  }
  return start;
}

LogFacts readMessages(const std::vector<fs::path>& files, const MessageSinks& sinks) {
  Reading reading(sinks, findStart(files));
  const LogReadResult read = readLog(files, [&](const Packet& packet) { reading.take(packet); });
  return reading.finish(read, files.front().filename().string());
}

}  // namespace lab::report
