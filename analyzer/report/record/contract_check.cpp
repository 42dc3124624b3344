#include "analyzer/report/record/contract_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <lab/analysis_t.hpp>
#include <lab/clock_t.hpp>
#include <lab/collective_t.hpp>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <lab/light_command_t.hpp>
#include <lab/light_delivery_t.hpp>
#include <lab/light_seen_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/link_status_t.hpp>
#include <lab/robot_calibration_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_senses_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <lab/tracker_status_t.hpp>
#include <sstream>

#include "analyzer/report_error.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/contract_upgrade.hpp"
#include "common/bus/fingerprints.hpp"
#include "common/process/version.hpp"

namespace lab::report {
namespace {

struct ChannelType {
  std::string_view channel;
  std::int64_t hash;
};

const auto& channelTypes() {
  static const std::array types{
      ChannelType{channels::kRobotCommand, robot_command_t::getHash()},
      ChannelType{channels::kRobotStop, robot_stop_t::getHash()},
      ChannelType{channels::kRobotSenses, robot_senses_t::getHash()},
      ChannelType{channels::kRobotStatus, robot_status_t::getHash()},
      ChannelType{channels::kRobotSteps, robot_steps_t::getHash()},
      ChannelType{channels::kRobotCalibration, robot_calibration_t::getHash()},
      ChannelType{channels::kCalibrationStatus, robot_calibration_t::getHash()},
      ChannelType{channels::kTrackedFrame, tracked_frame_t::getHash()},
      ChannelType{channels::kTrackedDetails, tracked_details_t::getHash()},
      ChannelType{channels::kTrackerStatus, tracker_status_t::getHash()},
      ChannelType{channels::kLightCommand, light_command_t::getHash()},
      ChannelType{channels::kLightStatus, light_status_t::getHash()},
      ChannelType{channels::kLightSeen, light_seen_t::getHash()},
      ChannelType{channels::kLightDelivery, light_delivery_t::getHash()},
      ChannelType{channels::kLinkStatus, link_status_t::getHash()},
      ChannelType{channels::kAnalysis, analysis_t::getHash()},
      ChannelType{channels::kCollective, collective_t::getHash()},
      ChannelType{channels::kServiceStatus, service_status_t::getHash()},
      ChannelType{channels::kExperimentEvent, experiment_event_t::getHash()},
      ChannelType{channels::kExperimentCommand, experiment_command_t::getHash()},
      ChannelType{channels::kExperimentStatus, experiment_status_t::getHash()},
      ChannelType{channels::kClock, clock_t::getHash()},
      ChannelType{channels::kSimTruth, sim_truth_t::getHash()}};
  return types;
}

/// The first message type in the log that is unknown or of another version.
std::string firstDifference(const std::string& ours, const std::string& theirs) {
  std::istringstream lines(theirs);
  for (std::string line; std::getline(lines, line);) {
    if (("\n" + ours).find("\n" + line + "\n") == std::string::npos) {
      return line.substr(0, line.find(' '));
    }
  }
  return {};
}

}  // namespace

bool isLabChannel(std::string_view channel) {
  return std::find(channels::kAll.begin(), channels::kAll.end(), channel) != channels::kAll.end();
}

bool ContractCheck::accept(std::string_view channel, std::int64_t fingerprint) {
  for (const ChannelType& type : channelTypes()) {
    if (type.channel != channel) continue;
    auto place = channels_.find(channel);
    if (place == channels_.end()) place = channels_.try_emplace(std::string(channel)).first;
    if (type.hash == fingerprint) {
      ++place->second.accepted;
      return true;
    }
    place->second.foreign_hash = fingerprint;
    return false;
  }
  return true;
}

void ContractCheck::take(const experiment_event_t& start) {
  contract_ = start.contract_version;
  version_ = start.version;
  fingerprints_ = start.fingerprints;
}

void ContractCheck::take(const service_status_t& status) {
  if (contract_ != 0) return;
  contract_ = status.contract_version;
  version_ = status.version;
}

std::string ContractCheck::changedType(const std::string& fingerprints) {
  if (fingerprints.empty()) return {};
  return firstDifference(fingerprintList() + olderFingerprintList(), fingerprints);
}

void ContractCheck::judge(const std::string& log_name) const {
  const std::string by = version_.empty() ? "" : fmt::format(" by Active Lab {}", version_);
  const std::string way_out = fmt::format(
      "this is Active Lab {}, which reads contract versions {} to {}. Analyze the log with the "
      "version that wrote it",
      kVersion, kOldestContractVersion, kContractVersion);
  if (contract_ != 0 && (contract_ < kOldestContractVersion || contract_ > kContractVersion)) {
    throw ReportError(fmt::format("{}: written{} under contract version {}; {}", log_name, by,
                                  contract_, way_out));
  }
  const std::string changed = changedType(fingerprints_);
  // With a known contract version its list of types is damaged: the messages themselves decide.
  if (!changed.empty() && contract_ == 0) {
    throw ReportError(
        fmt::format("{}: written{} with another {}; {}", log_name, by, changed, way_out));
  }
  // The run states its types, and they are ours: other messages are damaged or not the run's.
  if (!fingerprints_.empty() && changed.empty()) return;
  for (const auto& [name, channel] : channels_) {
    if (channel.accepted > 0 || channel.foreign_hash == 0) continue;
    throw ReportError(fmt::format("{}: {} carries messages{} of an unknown type (hash {:016x}); {}",
                                  log_name, name, by,
                                  static_cast<std::uint64_t>(channel.foreign_hash), way_out));
  }
}

}  // namespace lab::report
