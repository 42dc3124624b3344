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

constexpr std::size_t kMostReplaced = 64;         // replaced instances remembered per sender
constexpr std::int64_t kRemembered_us = 300'000;  // age of frames kept while no poses are needed

std::int64_t microseconds(double seconds) { return std::llround(seconds * 1e6); }

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

bool sameCommand(const LightCommand& a, const LightCommand& b) {
  return a.sender == b.sender && a.instance == b.instance && a.seq == b.seq;
}

/// Halves the number of columns and rows; each cell is the mean of up to four.
std::shared_ptr<const light::Image> halved(const light::Image& image) {
  auto half = std::make_shared<light::Image>();
  half->columns = (image.columns + 1) / 2;
  half->rows = (image.rows + 1) / 2;
  for (int row = 0; row < half->rows; ++row) {
    for (int column = 0; column < half->columns; ++column) {
      int sum = 0;
      for (const int down : {2 * row, std::min(2 * row + 1, image.rows - 1)}) {
        for (const int right : {2 * column, std::min(2 * column + 1, image.columns - 1)}) {
          sum += image.grey[static_cast<std::size_t>(down * image.columns + right)];
        }
      }
      half->grey.push_back(static_cast<std::uint8_t>((sum + 2) / 4));
    }
  }
  return half;
}

/// A list of static layers that shows the same as `field` during its cross-fade. The list grows
/// with each interrupted cross-fade. To stay below the size of a message, first the grids become
/// coarser, then the oldest pictures, which contribute least, are dropped.
std::vector<Layer> frozen(const Field& field) {
  if (!isMoving(field)) return field.layers;
  if (isUniform(field)) return {Layer{.intensity = evaluate(field, 0, 0)}};
  std::vector<Layer> layers = field.previous;
  layers.push_back({.kind = LayerKind::kFade, .intensity = field.mix});
  layers.insert(layers.end(), field.layers.begin(), field.layers.end());
  if (Scene::bytesOf(layers) > Scene::kMostBytes) {
    for (Layer& layer : layers) {
      if (layer.kind == LayerKind::kGrid && layer.pixels) layer.pixels = halved(*layer.pixels);
    }
  }
  const auto is_fade = [](const Layer& layer) { return layer.kind == LayerKind::kFade; };
  while (layers.size() > Scene::kMostResolved || Scene::bytesOf(layers) > Scene::kMostBytes) {
    const auto first_fade = std::find_if(layers.begin(), layers.end(), is_fade);
    if (first_fade == layers.end()) break;
    layers.erase(layers.begin(), first_fade + 1);
  }
  return layers;
}

/// Whether two lists show the same. The time that a grid is for is ignored.
bool showSame(const std::vector<Layer>& a, const std::vector<Layer>& b) {
  return std::ranges::equal(a, b, [](const Layer& left, const Layer& right) {
    if (left.kind != LayerKind::kGrid || left.seed == right.seed) return left == right;
    Layer other = left;
    other.seed = right.seed;
    return other == right;
  });
}

bool showSame(const Field& a, const Field& b) {
  return a.mix == b.mix && showSame(a.layers, b.layers) && showSame(a.previous, b.previous);
}

/// The sync patch: a square at the origin, as a grid of one pixel.
Layer syncPatch(double side, bool bright) {
  auto pixel = std::make_shared<light::Image>();
  pixel->columns = 1;
  pixel->rows = 1;
  pixel->grey = {static_cast<std::uint8_t>(bright ? 255 : 0)};
  Layer layer;
  layer.kind = LayerKind::kGrid;
  layer.x = layer.y = side / 2;
  layer.size = layer.inner = side;
  layer.intensity = 1;
  layer.pixels = std::move(pixel);
  return layer;
}

}  // namespace

ProjectorCore::ProjectorCore(Config config)
    : config_(std::move(config)),
      timeout_us_(microseconds(config_.command_timeout)),
      latency_us_(microseconds(config_.latency)),
      robots_(config_.scene_context.robots) {
  if (timeout_us_ <= 0) {
    throw std::invalid_argument("command_timeout = " + text(config_.command_timeout) +
                                " s, allowed: above 0");
  }
  if (const auto problem = light::validate(config_.safe_field)) {
    throw std::invalid_argument("safe_field." + *problem);
  }
  safe_label_ = "safe field: no command yet";
  safe_ = std::make_shared<Scene>(config_.safe_field);
  target_ = safe_;
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
  return Scene::problem(command.layers, config_.scene_context);
}

std::int64_t ProjectorCore::endOf(const Sender& sender) const {
  const std::int64_t hold = sender.active->hold_until_utime;
  return hold != 0 ? hold : sender.heard_utime + timeout_us_;
}

/// Makes room for another sender. @return false if all have commands
bool ProjectorCore::makeRoom() {
  if (senders_.size() < kMostSenders) return true;
  const auto has_command = [this](const auto& entry) {
    return isValid(entry.second) || !entry.second.scheduled.empty();
  };
  const auto first = std::ranges::min_element(senders_, {}, [&](const auto& entry) {
    return std::pair(has_command(entry), entry.second.heard_utime);
  });
  if (has_command(*first)) return false;
  senders_.erase(first);
  return true;
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
  if (known == senders_.end() && !makeRoom()) {
    return {Verdict::kRefused,
            "senders = " + std::to_string(kMostSenders + 1) + ", allowed: at most " +
                std::to_string(kMostSenders) +
                " with commands; end the programs that do not belong to this lab"};
  }
  Accepted accepted{command, command.from_utime == 0 ? received : command.from_utime};
  accepted.from_utime = std::max(command.from_utime, received);
  Sender sender = known != senders_.end() ? known->second : Sender{};
  if (known != senders_.end() && sender.instance != command.instance) {
    sender.replaced.push_back(sender.instance);
    if (sender.replaced.size() > kMostReplaced) sender.replaced.erase(sender.replaced.begin());
    sender.scheduled.clear();
  }
  // A command defines everything from its from_utime on, so it replaces commands scheduled for
  // later.
  std::erase_if(sender.scheduled,
                [&](const Accepted& later) { return later.from_utime >= accepted.from_utime; });
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
    Accepted& due = sender.scheduled.front();
    if (due.release) {
      leaving_ramp_ = due.ramp;
      sender.active.reset();
    } else {
      sender.active_since = due.from_utime;
      sender.active = std::move(due);
    }
    sender.scene = nullptr;
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

ProjectorCore::Sender* ProjectorCore::commander() {
  Sender* best = nullptr;
  for (auto& [name, sender] : senders_) {
    if (!isValid(sender)) continue;
    const auto rank = [](const Sender& one) {
      return std::pair(one.active->priority, one.active_since);
    };
    if (best == nullptr || rank(sender) > rank(*best)) best = &sender;
  }
  return best;
}

void ProjectorCore::chooseCommander() {
  Sender* const best = commander();
  const bool was_commanded = commanding_.has_value();
  if (best == nullptr && !was_commanded) return;
  if (best != nullptr && was_commanded && sameCommand(*best->active, *commanding_)) {
    return;
  }
  // The way in which the last command ended determines the ramp of the command that returns.
  bool silenced = false;
  if (was_commanded) {
    const std::optional<Accepted>& last = senders_.at(commanding_->sender).active;
    if (last && sameCommand(*last, *commanding_)) {
      silenced = commanding_->hold_until_utime == 0;
      leaving_ramp_ = silenced ? 0 : commanding_->ramp;
    } else if (last) {
      leaving_ramp_ = last->ramp;  // its sender took a lower priority
    }
  }
  if (best != nullptr) {
    const bool is_new = best->active_since == now_;
    if (!best->scene) {
      best->scene = std::make_shared<Scene>(best->active->layers, best->active->origin_utime,
                                            config_.scene_context);
    }
    startRamp(best->scene, is_new ? best->active->ramp : leaving_ramp_);
    commanding_ = *best->active;
  } else {
    safe_label_ = silenced ? "safe field: " + commanding_->sender + " fell silent"
                           : "safe field: " + commanding_->sender + " gave the light back";
    startRamp(safe_, leaving_ramp_);
    commanding_.reset();
  }
}

const std::vector<Layer>& ProjectorCore::layersOf(Scene& scene, const FrameTimes& times) {
  const Scene::Picture& picture = scene.at(times, robots_);
  trouble_ = picture.trouble;
  return picture.safe ? config_.safe_field : picture.layers;
}

light::Field ProjectorCore::fieldAt(const FrameTimes& times) {
  light::Field field;
  if (isFading(times.decided)) {
    field.previous = layersOf(*previous_, times);
    field.mix = static_cast<double>(times.decided - ramp_start_) / static_cast<double>(ramp_us_);
  }
  field.layers = layersOf(*target_, times);
  return field;
}

void ProjectorCore::startRamp(std::shared_ptr<Scene> scene, double ramp) {
  if (isFading(now_)) {
    previous_ = std::make_shared<Scene>(frozen(fieldAt({now_, now_ + latency_us_})));
  } else {
    previous_ = target_;
  }
  target_ = std::move(scene);
  ramp_start_ = now_;
  ramp_us_ = microseconds(ramp);
  ++version_;
}

std::vector<Scene*> ProjectorCore::scenes() const {
  std::vector<Scene*> all;
  const auto add = [&](const std::shared_ptr<Scene>& scene) {
    if (scene && std::ranges::find(all, scene.get()) == all.end()) all.push_back(scene.get());
  };
  for (const auto& [name, sender] : senders_) add(sender.scene);
  add(target_);
  add(previous_);
  return all;
}

void ProjectorCore::addFrame(ObservedFrame frame) {
  if (!waiting_.empty() && frame.instance != waiting_.back().instance) waiting_.clear();
  waiting_.push_back(std::move(frame));
}

/// Uses the waiting camera frames if a scene needs poses. Otherwise recent frames are kept, so that
/// a scene that begins to follow robots has their tracks at once.
void ProjectorCore::useWaitingFrames() {
  const std::vector<Scene*> all = scenes();
  const bool used = std::ranges::any_of(all, [](const Scene* one) { return one->needsPoses(); });
  shown_.tracked_frames.clear();
  if (!used) {
    robots_.forgetPoses();
    shown_.tracker_instance = 0;
    if (waiting_.empty()) return;
    const std::int64_t oldest = waiting_.back().utime - kRemembered_us;
    std::erase_if(waiting_, [oldest](const ObservedFrame& frame) { return frame.utime < oldest; });
    return;
  }
  for (const ObservedFrame& frame : waiting_) {
    shown_.tracker_instance = frame.instance;
    shown_.tracked_frames.push_back(frame.number);
    robots_.add(frame);
    for (Scene* scene : all) scene->addFrame(frame, robots_);
  }
  waiting_.clear();
}

const ShownFrame& ProjectorCore::frame(std::int64_t decided_utime, std::int64_t shown_utime) {
  advance(decided_utime);
  const bool is_new = shown_version_ != version_;
  const bool was_fading = light::isMoving(shown_.field);
  const std::int64_t tracker = shown_.tracker_instance;
  const bool turns =
      config_.sync_patch > 0 && (is_new || decided_utime >= sync_turn_ + microseconds(kSyncPeriod));
  if (turns) {
    shown_.sync = shown_.sync == 1 ? 0 : 1;
    sync_layer_ = syncPatch(config_.sync_patch, shown_.sync == 1);
    sync_turn_ = decided_utime;
  }
  if (!isFading(now_)) previous_ = nullptr;
  useWaitingFrames();
  shown_.changed = is_new || turns || was_fading || tracker != shown_.tracker_instance;
  if (shown_.changed || !target_->isStill()) {
    light::Field field = fieldAt({now_, shown_utime});
    if (config_.sync_patch > 0) {
      // A patch that was not toggled is the same layer, so that it does not count as a change.
      field.layers.push_back(sync_layer_);
      if (light::isMoving(field)) field.previous.push_back(sync_layer_);
    }
    shown_.changed = shown_.changed || !showSame(field, shown_.field) || trouble_ != shown_.trouble;
    shown_.field = std::move(field);
    shown_.trouble = trouble_;
  }
  shown_.moving = light::isMoving(shown_.field) || !target_->isStill();
  ++shown_.frame;
  shown_.presentation_utime = shown_utime;
  if (is_new) {
    shown_version_ = version_;
    shown_.first_shown_utime = shown_utime;
    shown_.commander = commanding_ ? commanding_->sender : std::string{};
    shown_.instance = commanding_ ? commanding_->instance : 0;
    shown_.seq = commanding_ ? commanding_->seq : 0;
    shown_.label = commanding_ ? commanding_->label : safe_label_;
  }
  return shown_;
}

}  // namespace lab::projector
