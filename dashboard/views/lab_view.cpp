#include "dashboard/views/lab_view.hpp"

#include <charconv>
#include <limits>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/message_sizes.hpp"
#include "common/bus/message_values.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/math/units.hpp"
#include "dashboard/health/advice.hpp"
#include "dashboard/views/bounded_messages.hpp"

namespace lab::dashboard {
namespace {

constexpr std::int64_t kUnwatched_us = 1'000'000;     // between frames while no page is open
constexpr std::size_t kMaxSenders = 16;               // of frames
constexpr std::int64_t kRunnerSilent_us = 1'000'000;  // it sends five messages a second
constexpr const char* kPool = "pool";
constexpr const char* kCrowd = "crowd";
constexpr const char* kRuns = "runtimes";
constexpr const char* kHistory = "history";

std::optional<std::int32_t> idOf(std::string_view text) {
  std::int32_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return id;
}

/// The value of an estimate; nan if there is none of that name.
double estimateOf(const analysis_t& analysis, std::string_view name) {
  for (const estimate_t& estimate : analysis.estimates) {
    if (estimate.name == name) return estimate.value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

LabView::LabView(Hub& hub, std::string sender, std::int64_t instance, Images images)
    : hub_(hub),
      sender_(std::move(sender)),
      instance_(instance),
      images_(std::move(images)),
      controls_(sender_, instance_) {
  subscribe();
}

template <class Message>
void LabView::on(std::string_view channel,
                 std::function<void(const Message&, std::int64_t)> handler) {
  takes_[std::string(channel)] = [handler = std::move(handler)](Bytes data, std::int64_t now) {
    Message message{};
    if (tooLarge<Message>(data) || !decode(data, message)) return std::int64_t{1};
    const auto found = removeImpossible(message);
    if (!found || found->usable) {
      bound(message);
      handler(message, now);
    }
    return found ? found->count : 0;
  };
}

void LabView::subscribe() {
  on<robot_status_t>(channels::kRobotStatus, [this](const auto& status, std::int64_t now) {
    robots_.take(status, now);
    run_times_.take(status);
    correlation_.take(status);
    controls_.take(status, now);
  });
  on<tracked_frame_t>(channels::kTrackedFrame, [this](const auto& frame, std::int64_t now) {
    robots_.take(frame, now);
    tracks_.take(frame);
    correlation_.take(frame);
  });
  on<robot_stop_t>(channels::kRobotStop,
                   [this](const auto& stop, std::int64_t now) { controls_.take(stop, now); });
  on<light_status_t>(channels::kLightStatus, [this](const auto& status, std::int64_t now) {
    light_.take(status);
    light_utime_ = now;
    controls_.take(status, now);
  });
  on<light_delivery_t>(channels::kLightDelivery,
                       [this](const auto& delivery, std::int64_t) { delivery_ = delivery; });
  on<analysis_t>(channels::kAnalysis, [this](const auto& analysis, std::int64_t) {
    curves_.take(analysis);
    if (analysis.robot_id != analysis_t::POOL) return;
    if (history_.take(analysis, timeline_.startUtime())) {
      publishNamedTopic(kHistory, analysis.program.name, history_.json(analysis.program.name));
    }
  });
  on<collective_t>(channels::kCollective, [this](const auto& message, std::int64_t) {
    crowd_.take(message, timeline_.startUtime());
  });
  on<service_status_t>(channels::kServiceStatus,
                       [this](const auto& status, std::int64_t now) { health_.take(status, now); });
  on<tracker_status_t>(channels::kTrackerStatus,
                       [this](const auto& status, std::int64_t now) { health_.take(status, now); });
  on<link_status_t>(channels::kLinkStatus,
                    [this](const auto& status, std::int64_t now) { health_.take(status, now); });
  on<experiment_event_t>(channels::kExperimentEvent,
                         [this](const auto& event, std::int64_t now) { take(event, now); });
  on<experiment_status_t>(channels::kExperimentStatus,
                          [this](const auto& status, std::int64_t now) { take(status, now); });
}

void LabView::begin(const Experiment& experiment, const std::string& run) {
  run_info_.set(experiment, run);
  useExperiment();
}

void LabView::useExperiment() {
  const Experiment& experiment = run_info_.experiment();
  light_.setArena(experiment.arena_width, experiment.arena_height);
  light_.setImages(images_(experiment, run_info_.run()));
  controls_.expect(commandedRobots(experiment));
  robots_.updateProgramIndices();
  run_info_changed_ = true;
}

bool LabView::isWanted(std::string_view channel, const MessageHeader& header) {
  if (channel != channels::kTrackedFrame) return true;
  // The camera may be faster than the page: use at most one frame per period of the page.
  auto last = frames_.find(header.sender);
  if (last == frames_.end()) {
    if (frames_.size() >= kMaxSenders) return false;
    last = frames_.emplace(header.sender, -1).first;
  }
  return std::exchange(last->second, header.utime / kFrame_us) != header.utime / kFrame_us;
}

void LabView::take(const Packet& packet, std::int64_t now) {
  const auto found = takes_.find(packet.channel);
  const std::optional<MessageHeader> header = peekHeader(packet.data);
  if (!header || impossibleHeader(packet.channel, header->utime, header->seq)) {
    health_.countNotUnderstood(packet.channel);
    // A stop is shown, whoever sent it.
    if (packet.channel == channels::kRobotStop) found->second(packet.data, now);
    return;
  }
  if (header->sender == sender_ && header->instance == instance_ &&
      packet.channel != channels::kServiceStatus) {
    return;
  }
  health_.count(packet.channel, *header, now);
  if (header->sender != sender_) bus_utime_ = now;
  if (run_info_.isRunner(header->sender, header->instance)) runner_utime_ = now;
  if (found == takes_.end() || !isWanted(packet.channel, *header)) return;
  const std::int64_t not_understood = found->second(packet.data, now);
  if (not_understood > 0) health_.countNotUnderstood(packet.channel, not_understood);
}

void LabView::take(const experiment_event_t& event, std::int64_t now) {
  // Only the run's own runner reports its events, and no other run begins beside it. A page that
  // was restarted in a run does not know its runner until the next START and takes all events.
  const bool is_known = !run_info_.runner().empty();
  const bool is_first = !is_known && event.kind != experiment_event_t::START;
  if (!is_first && !run_info_.isRunner(event.sender, event.instance)) {
    const bool runs = is_known && !timeline_.ended() && now - runner_utime_ < kRunnerSilent_us;
    if (runs || event.kind != experiment_event_t::START) {
      health_.countNotUnderstood(channels::kExperimentEvent);
      return;
    }
    runner_utime_ = now;
  }
  if (event.kind == experiment_event_t::START) {
    const std::string before = run_info_.text();
    const RunInfo::RunChange change = run_info_.take(event);
    if (run_info_.text() != before)
      correlation_.clear();  // its laws belong to the previous programs
    if (change == RunInfo::RunChange::kOtherRun) {
      health_.clear();
      clearRun();
      controls_.beginRun();
    }
    if (change != RunInfo::RunChange::kNone) useExperiment();
  }
  timeline_.take(event);
}

void LabView::take(const experiment_status_t& status, std::int64_t now) {
  const bool replay = isPlayed(status);
  if (script_ && script_->jumps != status.jumps && script_->instance == status.instance) {
    health_.clear();
    clearRun();
  }
  if (run_info_.run() != status.run || run_info_.replay() != replay) {
    const bool named = run_info_.run().empty();
    run_info_.setRun(status.run, replay);
    if (named && run_info_.known()) light_.setImages(images_(run_info_.experiment(), status.run));
    run_info_changed_ = true;
  }
  script_ = status;
  timeline_.take(status);
  controls_.take(status, now);
  publish("script", scriptJson(status));
  if (replay) publish("player", playerJson(status));
}

void LabView::clearRun() {
  robots_.clear();
  tracks_.clear();
  trails_.clear();
  run_times_.clear();
  curves_.clear();
  crowd_.clear();
  correlation_.clear();
  history_.clear();
  timeline_.clear();
  light_.clear();
  delivery_.reset();
  script_.reset();
  frames_.clear();
  for (const std::string& topic : named_topics_) hub_.remove(topic);
  named_topics_.clear();
  for (const char* topic : {".light", "crowd", "light", "delivery", "camera", "player"})
    hub_.remove(topic);
}

void LabView::publish(std::string_view topic, std::string text) {
  const Hub::Text before = hub_.newest(topic);
  if (!before || *before != text) hub_.publish(topic, std::move(text));
}

void LabView::publishNamedTopic(const std::string& kind, const std::string& name,
                                std::string text) {
  const std::string topic = kind + "/" + name;
  named_topics_.insert(topic);
  publish(topic, std::move(text));
}

void LabView::publishMoving(std::int64_t now, bool watched) {
  if (std::exchange(run_info_changed_, false)) publish("lab", run_info_.json());
  const bool moved = frame_count_ != robots_.frames();
  const std::int64_t wait = watched && moved ? kFrame_us - kFrame_us / 5 : kUnwatched_us;
  if (now - frame_utime_ >= wait) {
    frame_utime_ = now;
    frame_count_ = robots_.frames();
    publish("frame", robots_.frameJson(now));
  }
  if ((watched || light_.pixels().empty()) && light_.paint(now)) {
    // The event stream carries text only. The page requests these bytes when the version changes.
    hub_.publishQuietly(".light", {light_.pixels().begin(), light_.pixels().end()});
    publish("light", light_.json(run_info_.runner()));
  }
  if (std::exchange(timeline_version_, timeline_.version()) != timeline_.version()) {
    publish("timeline", timeline_.json());
  }
  publish("stop", controls_.stopJson());
  if (!controls_.noteJson().empty()) publish("note", controls_.noteJson());
}

void LabView::publishPools() {
  for (const std::string& name : curves_.takeChanged()) {
    const analysis_t& pool = *curves_.pool(name);
    Json json = analysisJson(pool);
    if (const auto curve = correlation_.curve(name, estimateOf(pool, "v"))) {
      json["curves"].push_back(curveJson(*curve));
    }
    publishNamedTopic(kPool, name, toText(json));
  }
  for (const std::string& name : crowd_.takeChanged()) {
    if (name.empty()) {
      publish(kCrowd, crowd_.json(name));
    } else {
      publishNamedTopic(kCrowd, name, crowd_.json(name));
    }
  }
  for (const std::string& name : run_times_.takeChanged()) {
    publishNamedTopic(kRuns, name, run_times_.json(name));
  }
}

void LabView::publishTotals(std::int64_t now, const ServerFacts& server) {
  health_.tick(now);
  publish("robots", robots_.robotsJson(now));
  publishPools();
  if (delivery_) publish("delivery", deliveryJson(*delivery_));
  publish("health", toText(healthJson(now, server)));
  if (health_.tracker()) publish("camera", cameraJson());
  const Json silent = bus_utime_ == 0 ? Json() : number(units::seconds(now - bus_utime_));
  publish("pulse", toText({{"t_us", now}, {"bus_silent_s", silent}}));
}

Json LabView::healthJson(std::int64_t now, const ServerFacts& server) const {
  Json json = health_.json(now, server.host, server.uses);
  json["advice"] = adviceJson(adviceOn({.run_info = run_info_,
                                        .health = health_,
                                        .robots = robots_,
                                        .light = light_.status(),
                                        .light_utime = light_utime_,
                                        .bus_utime = bus_utime_,
                                        .ended = timeline_.ended(),
                                        .now = now}));
  const auto own = server.uses.find(server.pid);
  const bool known = own != server.uses.end();
  json["server"] = {{"viewers", server.viewers},
                    {"refused",
                     {{"host", server.refusals.host},
                      {"origin", server.refusals.origin},
                      {"token", server.refusals.token},
                      {"path", server.refusals.path},
                      {"malformed", server.refusals.malformed},
                      {"oversized", server.refusals.oversized},
                      {"crowded", server.refusals.crowded}}},
                    {"left_out",
                     {{"robots", robots_.dropped()},
                      {"analyses", curves_.leftOut()},
                      {"streams", health_.streamsLeftOut()}}},
                    {"cpu_percent", known ? number(own->second.cpu_percent) : Json()},
                    {"memory_MB", known ? number(own->second.memory_MB) : Json()}};
  return json;
}

std::string LabView::cameraJson() const {
  const tracker_status_t& tracker = *health_.tracker();
  return toText(
      {{"state", trackerStateName(tracker.state)},
       {"width_px", tracker.width},
       {"height_px", tracker.height},
       {"fps", number(tracker.fps)},
       {"trouble", tracker.trouble},
       {"picture", !run_info_.replay() && run_info_.experiment().camera.debug_port != 0}});
}

std::optional<std::string> LabView::query(std::string_view what, std::string_view which,
                                          std::int64_t now) {
  if (what == "trails") {
    if (trails_.empty() || now - trails_utime_ >= kTrails_us) {
      trails_ = tracks_.trailsJson();
      trails_utime_ = now;
    }
    return trails_;
  }
  const std::optional<std::int32_t> id = idOf(which);
  if (!id) return std::nullopt;
  if (what == "analysis") return curves_.robotJson(*id);
  if (what == "robot") return robots_.robotJson(*id, now);
  if (what == "speeds") return tracks_.speedsJson(*id);
  return std::nullopt;
}

}  // namespace lab::dashboard
