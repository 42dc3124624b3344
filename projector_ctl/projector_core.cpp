#include "projector_ctl/projector_core.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

namespace lab::projector {

namespace {

using light::Field;
using light::Layer;
using light::LayerKind;

constexpr std::size_t kMostReplaced = 64;  // instances of one sender; older ones are long gone

std::int64_t microseconds(double seconds) { return std::llround(seconds * 1e6); }

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

bool sameCommand(const LightCommand& a, const LightCommand& b) {
  return a.sender == b.sender && a.instance == b.instance && a.seq == b.seq;
}

/// A list of layers that shows what `field` shows. It grows by one picture a call, so past the
/// limit the pictures furthest back, which show the least, are left out.
std::vector<Layer> frozen(const Field& field) {
  if (!isMoving(field)) return field.layers;
  if (isUniform(field)) return {Layer{.intensity = evaluate(field, 0, 0)}};
  std::vector<Layer> layers = field.previous;
  layers.push_back({.kind = LayerKind::kFade, .intensity = field.mix});
  layers.insert(layers.end(), field.layers.begin(), field.layers.end());
  const auto is_fade = [](const Layer& layer) { return layer.kind == LayerKind::kFade; };
  while (layers.size() > light::kMostLayers) {
    const auto first_fade = std::find_if(layers.begin(), layers.end(), is_fade);
    if (first_fade == layers.end()) break;
    layers.erase(layers.begin(), first_fade + 1);
  }
  return layers;
}

}  // namespace

ProjectorCore::ProjectorCore(Config config)
    : config_(std::move(config)), timeout_us_(microseconds(config_.command_timeout)) {
  if (timeout_us_ <= 0) {
    throw std::invalid_argument("command_timeout = " + text(config_.command_timeout) +
                                " s, allowed: above 0");
  }
  if (const auto problem = light::validate(config_.safe_field)) {
    throw std::invalid_argument("safe_field." + *problem);
  }
  safe_label_ = "safe field: no command yet";
  field_.layers = config_.safe_field;
}

std::optional<std::string> ProjectorCore::problem(const LightCommand& command,
                                                  std::int64_t received_utime) const {
  const auto seconds = [&](std::int64_t utime) {
    return static_cast<double>(utime - received_utime) * 1e-6;
  };
  if (command.sender.empty()) return "sender = \"\", allowed: the name of who commands";
  if (!(command.ramp >= 0 && command.ramp <= kLongestRamp)) {
    return "ramp = " + text(command.ramp) + " s, allowed: 0 to " + text(kLongestRamp) + " s";
  }
  if (command.from_utime < 0 || seconds(command.from_utime) > kFurthestStart) {
    return "from_utime = " + std::to_string(command.from_utime) +
           " us, allowed: 0 for at once, or at most a day ahead in microseconds since 1970";
  }
  if (command.hold_until_utime != 0 &&
      command.hold_until_utime <= std::max(command.from_utime, received_utime)) {
    return "hold_until_utime = " + std::to_string(command.hold_until_utime) +
           " us, allowed: 0, or after now and after from_utime";
  }
  if (command.release) return {};
  for (std::size_t i = 0; i < command.layers.size(); ++i) {
    if (command.layers[i].kind == LayerKind::kFade) {
      return "layers[" + std::to_string(i) + "].kind = 10, allowed in a command: 1 to 9";
    }
  }
  return light::validate(command.layers);
}

std::int64_t ProjectorCore::endOf(const Sender& sender) const {
  const std::int64_t hold = sender.active->hold_until_utime;
  return hold != 0 ? hold : sender.heard_utime + timeout_us_;
}

Answer ProjectorCore::apply(const LightCommand& command, std::int64_t received_utime) {
  const std::int64_t received = std::max(received_utime, now_);
  advance(received);

  const auto known = senders_.find(command.sender);
  if (known != senders_.end()) {
    Sender& sender = known->second;
    const bool same = sender.instance == command.instance;
    if (std::count(sender.replaced.begin(), sender.replaced.end(), command.instance) > 0 ||
        (same && command.seq < sender.newest_seq)) {
      return {Verdict::kStale};
    }
    if (same && command.seq == sender.newest_seq) {
      const bool was_standing = sender.active && received < endOf(sender);
      sender.heard_utime = received;
      if (sender.active && !was_standing) sender.active_since = received;
      chooseCommander();
      return {Verdict::kRepeated};
    }
  }

  if (auto reason = problem(command, received)) return {Verdict::kRefused, std::move(*reason)};
  LightCommand accepted = command;
  accepted.from_utime = std::max(command.from_utime, received);
  Sender sender = known != senders_.end() ? known->second : Sender{};
  if (known != senders_.end() && sender.instance != command.instance) {
    sender.replaced.push_back(sender.instance);
    if (sender.replaced.size() > kMostReplaced) sender.replaced.erase(sender.replaced.begin());
    sender.scheduled.clear();
  }
  // A command is the whole wish from its from_utime on: it replaces what was planned for later.
  std::erase_if(sender.scheduled,
                [&](const LightCommand& later) { return later.from_utime >= accepted.from_utime; });
  if (sender.scheduled.size() >= kMostScheduled) {
    return {Verdict::kRefused, "from_utime = " + std::to_string(command.from_utime) +
                                   " us, allowed: at most " + std::to_string(kMostScheduled) +
                                   " commands of one sender waiting for their time"};
  }
  sender.instance = command.instance;
  sender.newest_seq = command.seq;
  sender.heard_utime = received;
  sender.scheduled.push_back(std::move(accepted));
  Sender& stored = senders_[command.sender] = std::move(sender);
  bringIntoForce(stored);
  chooseCommander();
  return {Verdict::kAccepted};
}

void ProjectorCore::bringIntoForce(Sender& sender) {
  while (!sender.scheduled.empty() && sender.scheduled.front().from_utime <= now_) {
    LightCommand& due = sender.scheduled.front();
    if (due.release) {
      leaving_ramp_ = due.ramp;
      sender.active.reset();
    } else {
      sender.active_since = due.from_utime;
      sender.active = std::move(due);
    }
    sender.scheduled.erase(sender.scheduled.begin());
  }
}

void ProjectorCore::advance(std::int64_t utime) {
  constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  while (true) {
    std::int64_t next = kNever;
    const auto consider = [&](std::int64_t event) {
      if (event > now_) next = std::min(next, event);
    };
    for (const auto& [name, sender] : senders_) {
      if (!sender.scheduled.empty()) consider(sender.scheduled.front().from_utime);
      if (sender.active) consider(endOf(sender));
    }
    if (next > utime) break;
    now_ = next;
    for (auto& [name, sender] : senders_) bringIntoForce(sender);
    chooseCommander();
  }
  now_ = std::max(now_, utime);
}

const ProjectorCore::Sender* ProjectorCore::commander() const {
  const Sender* best = nullptr;
  for (const auto& [name, sender] : senders_) {
    if (!sender.active || now_ >= endOf(sender)) continue;
    const auto rank = [](const Sender& one) {
      return std::pair(one.active->priority, one.active_since);
    };
    if (best == nullptr || rank(sender) > rank(*best)) best = &sender;
  }
  return best;
}

void ProjectorCore::chooseCommander() {
  const Sender* best = commander();
  const bool was_commanded = commanding_.has_value();
  if (best == nullptr && !was_commanded) return;
  if (best != nullptr && was_commanded && sameCommand(*best->active, *commanding_)) {
    return;
  }
  // How the last command went decides how what it covered comes back.
  bool silenced = false;
  if (was_commanded) {
    const std::optional<LightCommand>& last = senders_.at(commanding_->sender).active;
    if (last && sameCommand(*last, *commanding_)) {
      silenced = commanding_->hold_until_utime == 0;
      leaving_ramp_ = silenced ? 0 : commanding_->ramp;
    } else if (last) {
      leaving_ramp_ = last->ramp;  // its sender took a lower priority
    }
  }
  if (best != nullptr) {
    const bool is_new = best->active_since == now_;
    startRamp(best->active->layers, is_new ? best->active->ramp : leaving_ramp_);
    commanding_ = *best->active;
  } else {
    safe_label_ = silenced ? "safe field: " + commanding_->sender + " fell silent"
                           : "safe field: " + commanding_->sender + " gave the light back";
    startRamp(config_.safe_field, leaving_ramp_);
    commanding_.reset();
  }
}

light::Field ProjectorCore::fieldAt(std::int64_t utime) const {
  const std::int64_t since = utime - ramp_start_;
  if (since >= ramp_us_) return {field_.layers, {}, 1};
  return {field_.layers, field_.previous,
          static_cast<double>(since) / static_cast<double>(ramp_us_)};
}

void ProjectorCore::startRamp(const std::vector<Layer>& layers, double ramp) {
  field_.previous = frozen(fieldAt(now_));
  field_.layers = layers;
  ramp_start_ = now_;
  ramp_us_ = microseconds(ramp);
  ++version_;
}

const Shown& ProjectorCore::frame(std::int64_t presentation_utime) {
  advance(presentation_utime);
  shown_.changed = shown_version_ != version_ || shown_.moving;
  if (shown_.changed) shown_.field = fieldAt(now_);
  shown_.moving = light::isMoving(shown_.field);
  ++shown_.frame;
  shown_.presentation_utime = presentation_utime;
  if (shown_version_ != version_) {
    shown_version_ = version_;
    shown_.first_shown_utime = presentation_utime;
    shown_.commander = commanding_ ? commanding_->sender : std::string{};
    shown_.instance = commanding_ ? commanding_->instance : 0;
    shown_.seq = commanding_ ? commanding_->seq : 0;
    shown_.label = commanding_ ? commanding_->label : safe_label_;
  }
  return shown_;
}

}  // namespace lab::projector
