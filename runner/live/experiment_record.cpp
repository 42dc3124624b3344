#include "runner/live/experiment_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/fingerprints.hpp"
#include "common/process/version.hpp"
#include "common/text/utf8.hpp"

namespace lab::runner {
namespace {

// Far above what the services of a lab report.
constexpr std::size_t kMostErrors = 1000;
// [bytes] A remark of 500 characters has up to 2000, the errors in a heartbeat up to 1000, and
// names are added.
constexpr std::size_t kLongestText = 3000;

/// Texts of the bus may have any length, and each is sent three times.
std::string cut(const std::string& text) { return std::string(utf8Prefix(text, kLongestText)); }

experiment_event_t eventOf(std::int8_t kind, const std::string& text) {
  experiment_event_t event{};
  event.kind = kind;
  event.text = text;
  return event;
}

}  // namespace

void ExperimentRecord::start() {
  experiment_event_t event = eventOf(experiment_event_t::START, effective_);
  event.contract_version = kContractVersion;
  event.fingerprints = fingerprintList();
  event.version = kVersion;
  write(std::move(event));
  if (light_calibration_.empty()) return;
  experiment_event_t calibration = eventOf(experiment_event_t::CALIBRATION, light_calibration_);
  calibration.label = "light";
  write(std::move(calibration));
}

void ExperimentRecord::write(experiment_event_t event) {
  event.utime = loop_.now();
  for (int copy = 0; copy < kCopies; ++copy) node_.publish(channels::kExperimentEvent, event);
}

void ExperimentRecord::fault(const std::string& text) {
  const std::string what = cut(text);
  faults_.push_back(what);
  node_.noteError(what);
  write(eventOf(experiment_event_t::FAULT, what));
}

void ExperimentRecord::mark(const std::string& what) {
  write(eventOf(experiment_event_t::MARK, cut(what)));
}

void ExperimentRecord::markRequest(const std::string& what, const std::string& way_out) {
  markAndAnnounce("request", what, way_out);
}

void ExperimentRecord::markAndAnnounce(const std::string& label, const std::string& text,
                                       const std::string& way_out) {
  const std::string what = cut(text);
  mark(what);
  if (!announce_) return;
  std::string line = what + (way_out.empty() ? "" : " (" + way_out + ")");
  repairUtf8(line);
  // Whoever can send on the bus must not control the terminal.
  std::ranges::replace_if(
      line, [](char letter) { return (letter >= 0 && letter < ' ') || letter == 0x7f; }, ' ');
  announce_(label, line);
}

void ExperimentRecord::limitReached(const std::string& what) {
  if (limits_reached_.insert(what).second) fault(what);
}

void ExperimentRecord::serviceError(const std::string& text, bool costs_data) {
  const std::string what = cut(text);
  if (service_errors_.contains(what)) return;
  if (service_errors_.size() >= kMostErrors) {
    limitReached(
        fmt::format("services reported more than {} different errors; further ones are "
                    "not recorded: their output is in the run's folder",
                    kMostErrors));
    return;
  }
  service_errors_.insert(what);
  costs_data ? fault(what) : markAndAnnounce("warning", what, {});
}

void ExperimentRecord::end(const std::string& why) {
  write(eventOf(experiment_event_t::END, cut(why)));
}

}  // namespace lab::runner
