#include "analyzer/report/record/event_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace lab::report {
namespace {

// More than any run has. What exceeds them is counted.
constexpr std::size_t kMostSteps = 100'000;
constexpr std::size_t kMostRemarks = 10'000;
constexpr std::size_t kMostServices = 500;
/// The channel of the rows in which robot_bridge counts what its serial lines carried.
constexpr std::string_view kSerialLine = "serial line";

}  // namespace

void EventRecord::take(const experiment_event_t& event) {
  if (event.kind == experiment_event_t::STEP) {
    takeStep(event);
    return;
  }
  if (event.kind == experiment_event_t::START) {
    if (start_utime_ == 0) start_utime_ = event.utime;
    version_ = event.version;
    contract_version_ = event.contract_version;
    return;
  }
  if (event.kind == experiment_event_t::CALIBRATION) {
    if (event.label == "light") light_calibration_ = event.text;
    return;
  }
  // Marks do not take the place of faults.
  if ((event.kind == experiment_event_t::MARK && marks_.size() >= kMostRemarks) ||
      (event.kind == experiment_event_t::FAULT && faults_.size() >= kMostRemarks)) {
    left_out_ += known_.contains({event.utime, event.kind, event.text}) ? 0 : 1;
    return;
  }
  if (!known_.emplace(event.utime, event.kind, event.text).second) return;
  switch (event.kind) {
    case experiment_event_t::FAULT:
      faults_.push_back({event.utime, event.text});
      break;
    case experiment_event_t::MARK:
      marks_.push_back({event.utime, event.text});
      break;
    case experiment_event_t::END:
      end_utime_ = event.utime;
      end_reason_ = event.text;
      break;
    default:
      break;
  }
}

void EventRecord::takeStep(const experiment_event_t& event) {
  if (steps_.size() >= kMostSteps && !steps_.contains(event.step)) return;
  StepRecord& step = steps_[event.step];
  step.number = event.step;
  step.label = event.label;
  step.commanded_utime = event.commanded_utime;
  step.presented_utime = event.presented_utime;
  step.seen_utime = event.seen_utime;
  step.ended_by = event.ended_by;
  step.first_acted_utime = event.first_acted_utime;
  step.last_acted_utime = event.last_acted_utime;
  step.robots_acted = event.robots_acted;
  step.robots_expected = event.robots_expected;
}

void EventRecord::finish(RunRecord& record) const {
  for (const auto& [number, step] : steps_) record.steps.push_back(step);
  record.faults = faults_;
  record.marks = marks_;
  if (left_out_ > 0) {
    record.marks.push_back(
        {end_utime_,
         fmt::format("{} messages of further marks and faults are not listed", left_out_)});
  }
  if (!light_calibration_.empty()) {
    record.light_calibration =
        parseLightFile("calibration of light in the log", light_calibration_);
  }
  record.version = version_;
  record.contract_version = contract_version_;
  record.ended = end_utime_ != 0;
  record.end_reason = end_reason_;
  // Time 0 is the command of the first step, else the START event, the first frame, or the first
  // message.
  record.start_utime = start_utime_;
  if (const auto first = steps_.find(0); first != steps_.end()) {
    record.start_utime = first->second.commanded_utime;
  }
  const auto& frames = record.tracks.frames;
  if (record.start_utime == 0 && !frames.empty()) record.start_utime = frames.front().utime;
  if (record.start_utime == 0) record.start_utime = record.log.first_utime;
  record.end_utime = end_utime_;
  if (record.end_utime == 0 && !frames.empty()) record.end_utime = frames.back().utime;
  record.end_utime = std::max(record.end_utime, record.start_utime);
}

void ServiceRecords::take(const service_status_t& status) {
  const auto found = std::find_if(services_.begin(), services_.end(), [&](const auto& known) {
    return known.first == status.instance && known.second.name == status.sender;
  });
  ServiceRecord* service = nullptr;
  if (found != services_.end()) {
    service = &found->second;
  } else {
    // A shell command such as `lab mark` sends only its final counts: it is not a service.
    if (status.state == service_status_t::ENDED || services_.size() >= kMostServices) return;
    const auto earlier = std::count_if(services_.begin(), services_.end(), [&](const auto& known) {
      return known.second.name == status.sender;
    });
    service = &services_.emplace_back(status.instance, ServiceRecord{}).second;
    service->name = status.sender;
    service->start = static_cast<int>(earlier) + 1;
    service->version = status.version;
    service->origin = status.origin;
  }
  service->ended = service->ended || status.state == service_status_t::ENDED;
  if (!status.last_error.empty()) service->last_error = status.last_error;
  last_[status.sender] = status;
}

void ServiceRecords::finish(RunRecord& record) const {
  for (const auto& [instance, service] : services_) record.services.push_back(service);
  std::sort(record.services.begin(), record.services.end(),
            [](const ServiceRecord& a, const ServiceRecord& b) {
              return std::tie(a.name, a.start) < std::tie(b.name, b.start);
            });
  for (const auto& [name, status] : last_) {
    for (const stream_count_t& stream : status.received) {
      if (stream.channel == kSerialLine) {
        record.serial_lines.push_back(
            {stream.sender, stream.received, stream.lost, stream.decode_errors});
        continue;
      }
      if (stream.lost == 0 && stream.decode_errors == 0) continue;
      record.listeners.push_back(
          {name, stream.channel, stream.sender, stream.lost, stream.decode_errors});
    }
  }
}

}  // namespace lab::report
