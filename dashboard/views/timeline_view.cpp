#include "dashboard/views/timeline_view.hpp"

#include <algorithm>

#include "common/math/units.hpp"
#include "dashboard/views/json.hpp"

namespace lab::dashboard {
namespace {

const char* phaseName(std::int8_t phase) {
  switch (phase) {
    case experiment_status_t::PREPARING:
      return "preparing";
    case experiment_status_t::SCRIPT:
    case experiment_status_t::PLAYING:
      return "script";
    case experiment_status_t::PAUSED:
    case experiment_status_t::PLAY_PAUSED:
      return "paused";
    case experiment_status_t::LEAVING:
      return "leaving";
    case experiment_status_t::ENDED:
      return "ended";
    default:
      return "preparing";
  }
}

Json stepJson(const experiment_event_t& step) {
  return {{"number", step.step},
          {"label", step.label},
          {"commanded_us", timeOrNull(step.commanded_utime)},
          {"presented_us", timeOrNull(step.presented_utime)},
          {"seen_us", timeOrNull(step.seen_utime)},
          {"first_acted_us", timeOrNull(step.first_acted_utime)},
          {"last_acted_us", timeOrNull(step.last_acted_utime)},
          {"robots_acted", step.robots_acted},
          {"robots_expected", step.robots_expected},
          {"ended_by", step.ended_by}};
}

template <class Remarks>
Json remarksJson(const Remarks& remarks) {
  Json json = Json::array();
  for (const auto& remark : remarks.newest) {
    json.push_back({{"t_us", remark.utime}, {"text", remark.text}});
  }
  return json;
}

}  // namespace

bool TimelineView::Remarks::add(const experiment_event_t& event) {
  const Remark remark{event.utime, event.text};
  if (std::ranges::find(newest, remark) != newest.end()) return false;
  newest.push_back(remark);
  if (newest.size() > kMaxRemarks) {
    newest.pop_front();
    ++before;
  }
  return true;
}

void TimelineView::take(const experiment_event_t& event) {
  bool changed = true;
  switch (event.kind) {
    case experiment_event_t::START:
      changed = start_utime_ == 0;
      if (changed) start_utime_ = event.utime;
      break;
    case experiment_event_t::STEP:
      // A step that was omitted already may be repeated.
      if (steps_.size() == kMaxSteps && event.step < steps_.begin()->first) return;
      steps_[event.step] = event;
      if (steps_.size() > kMaxSteps) {
        steps_.erase(steps_.begin());
        ++steps_before_;
      }
      break;
    case experiment_event_t::MARK:
      changed = marks_.add(event);
      break;
    case experiment_event_t::FAULT:
      changed = faults_.add(event);
      break;
    case experiment_event_t::END:
      changed = !end_;
      if (changed) end_ = {event.utime, event.text};
      break;
    default:
      changed = false;
      break;
  }
  if (changed) ++version_;
}

void TimelineView::take(const experiment_status_t& status) {
  constexpr std::int64_t kRounding_us = 100'000;
  const bool runs =
      status.phase == experiment_status_t::SCRIPT || status.phase == experiment_status_t::PAUSED;
  if (!runs || !(status.elapsed >= 0) || status.elapsed > units::seconds(status.utime)) return;
  const std::int64_t begin = status.utime - units::microseconds(status.elapsed);
  if (counted_back_ && begin > start_utime_ - kRounding_us) return;
  counted_back_ = true;
  if (begin == start_utime_) return;
  start_utime_ = begin;
  ++version_;
}

void TimelineView::clear() {
  const std::uint64_t version = version_ + 1;
  *this = TimelineView();
  version_ = version;
}

std::string TimelineView::json() const {
  Json steps = Json::array();
  for (const auto& [number, step] : steps_) steps.push_back(stepJson(step));
  Json json = {{"start_us", timeOrNull(start_utime_)}, {"steps", std::move(steps)},
               {"steps_before", steps_before_},        {"marks", remarksJson(marks_)},
               {"marks_before", marks_.before},        {"faults", remarksJson(faults_)},
               {"faults_before", faults_.before},      {"end", nullptr}};
  if (end_) json["end"] = {{"t_us", end_->utime}, {"text", end_->text}};
  return toText(json);
}

std::string deliveryJson(const light_delivery_t& delivery) {
  Json delays = Json::array();
  for (const light_delay_t& delay : delivery.delays) {
    delays.push_back({{"until", delay.until},
                      {"count", delay.count},
                      {"p50_s", number(delay.p50)},
                      {"p95_s", number(delay.p95)},
                      {"p99_s", number(delay.p99)},
                      {"max_s", number(delay.max)}});
  }
  return toText({{"steps", delivery.steps}, {"delays", std::move(delays)}});
}

std::string scriptJson(const experiment_status_t& status) {
  return toText({{"phase", phaseName(status.phase)},
                 {"elapsed_s", number(status.elapsed)},
                 {"left_s", number(status.left)},
                 {"at_most", status.at_most != 0},
                 {"step", status.step},
                 {"label", status.label},
                 {"step_left_s", number(status.step_left)},
                 {"stop", status.stop}});
}

bool isPlayed(const experiment_status_t& status) {
  return status.phase == experiment_status_t::PLAYING ||
         status.phase == experiment_status_t::PLAY_PAUSED;
}

std::string playerJson(const experiment_status_t& status) {
  return toText({{"at_s", number(status.elapsed)},
                 {"length_s", number(status.elapsed + status.left)},
                 {"speed", number(status.rate)},
                 {"paused", status.phase == experiment_status_t::PLAY_PAUSED},
                 {"jumps", status.jumps}});
}

}  // namespace lab::dashboard
