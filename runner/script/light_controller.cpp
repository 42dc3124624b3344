#include "runner/script/light_controller.hpp"

#include <algorithm>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "light/field/field.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kLightPeriod_us =
    500'000;  // 2 Hz: commands are repeated because LCM may drop messages
constexpr std::int64_t kDeliveryTimeout_us = 2'000'000;
constexpr int kMostTransitions = 100;  // at once, of a script that is late

}  // namespace

LightController::LightController(Node& node, Loop& loop, const Experiment& experiment,
                                 const std::filesystem::path& directory, Hooks hooks)
    : node_(node),
      loop_(loop),
      experiment_(experiment),
      hooks_(std::move(hooks)),
      images_(loadImages(experiment, directory)),
      player_(experiment) {
  node_.subscribe<light_status_t>(channels::kLightStatus,
                                  [this](const light_status_t& status) { take(status); });
  node_.subscribe<light_seen_t>(channels::kLightSeen, [this](const light_seen_t& seen) {
    seen_light_utime_ = seen.utime;
    if (watch_) watch_->take(seen);
    finishWatch();
  });
}

void LightController::begin() {
  const std::int64_t now = loop_.now();
  loop_.every(kLightPeriod_us, now, [this] { send(); });
  loop_.every(units::kSecond_us, now + units::kSecond_us, [this] {
    light_delivery_t delivery = deliveries_.message();
    node_.publish(channels::kLightDelivery, delivery);
  });
}

void LightController::send() {
  if (command_.seq == 0) return;
  command_.utime = 0;
  node_.publishCommand(channels::kLightCommand, command_);
}

void LightController::showEverywhere(double intensity, const std::string& label) {
  LayerSpec uniform;
  uniform.intensity = intensity;
  ++command_.seq;
  command_.from_utime = loop_.now();
  command_.ramp = 0;
  command_.label = label;
  setLayers(command_, {{toLightLayer(uniform), {}}});
  send();
}

void LightController::startScript() {
  playing_ = true;
  player_.begin(loop_.now());
  setTimers();
}

/// Timers that were set before a pause fire too early and then do nothing.
void LightController::setTimers() {
  loop_.at(player_.endUtime(), [this] { update(); });
  setStepTimer();
}

void LightController::pause() { player_.pause(loop_.now()); }

void LightController::resume() {
  player_.resume(loop_.now());
  setTimers();
  update();
}

void LightController::close() {
  playing_ = false;
  closeWatch();
}

void LightController::update() {
  for (int i = 0; playing_ && i < kMostTransitions; ++i) {
    const auto transition = player_.nextTransition(loop_.now());
    if (!transition) {
      if (std::exchange(needs_timer_, false)) setStepTimer();
      return;
    }
    needs_timer_ = true;
    if (!transition->fault.empty()) hooks_.fault(transition->fault);
    if (transition->kind == ScriptTransition::Kind::kStep) {
      show(*transition);
    } else {
      hooks_.end(*transition);
    }
  }
  // After a suspension of the machine, hours of steps may be due. Ctrl-C must work meanwhile.
  if (playing_) loop_.soon([this] { update(); });
}

void LightController::setStepTimer() {
  const auto due = player_.due();
  // The end of the run has its own timer.
  if (due && *due < player_.endUtime()) loop_.at(*due, [this] { update(); });
}

void LightController::show(const ScriptTransition& transition) {
  closeWatch();
  const LightStep& step = experiment_.light.steps[transition.index];
  ++command_.seq;
  command_.from_utime = loop_.now();
  command_.ramp = step.ramp;
  command_.label = step.label;
  crowd_.emplace(experiment_, step.layers);
  crowd_changed_ = false;
  setLayers(command_, toDrivenLayers(crowd_->layers(), images_));
  if (!crowd_->given()) crowd_.reset();
  send();

  experiment_event_t event{};
  event.kind = experiment_event_t::STEP;
  event.step = transition.number;
  event.label = step.label;
  event.ended_by = transition.ended_by;
  event.commanded_utime = command_.from_utime;
  watch_.emplace(event, node_.identity().instance, command_.seq, expectedProgram(),
                 commandedRobots(experiment_).size());
  if (loop_.now() - seen_light_utime_ < units::kSecond_us) watch_->expectSeen();
  loop_.at(loop_.now() + kDeliveryTimeout_us, [this, seq = command_.seq] {
    if (command_.seq == seq) closeWatch();
  });
  hooks_.began();
}

std::optional<program_id_t> LightController::expectedProgram() const {
  const light::Field field = toField(command_.layers, images_.store);
  const bool steady = command_.ramp == 0 && command_.drives.empty();
  if (!steady || !light::isUniform(field) || !hooks_.chosen_by_light()) return std::nullopt;
  const double intensity = light::evaluate(field, 0, 0);
  const LightTable& table = experiment_.light_table;
  std::optional<program_id_t> expected = program_id_t{};
  for (const LightBand& band : table.bands) {
    // Within the hysteresis of a band edge a robot may keep its program, so none is expected.
    if (!contains(band, intensity, table.hysteresis)) continue;
    if (!contains(band, intensity) || expected->hash != 0) return std::nullopt;
    expected = toId(experiment_.programs.at(band.program));
  }
  return expected;
}

void LightController::finishWatch() {
  if (watch_ && watch_->complete()) closeWatch();
}

void LightController::closeWatch() {
  if (!watch_) return;
  deliveries_.add(watch_->event());
  hooks_.record(watch_->event());
  watch_.reset();
}

void LightController::take(const light_status_t& status) {
  if (watch_) watch_->take(status);
  finishWatch();
  const bool own = status.command_instance == node_.identity().instance;
  if (own && status.command_seq == command_.seq) hooks_.shown();
}

void LightController::take(const robot_status_t& status) {
  if (watch_) watch_->take(status);
  finishWatch();
  player_.take(status);
  update();
}

void LightController::take(const analysis_t& analysis) {
  player_.take(analysis);
  update();
}

void LightController::take(const collective_t& message) {
  player_.take(message);
  update();
  if (!playing_ || player_.paused() || !crowd_) return;
  crowd_changed_ = crowd_->take(message) || crowd_changed_;
  // The delays of a step are those of its first command: it is not replaced while they are
  // measured.
  if (!crowd_changed_ || watch_) return;
  crowd_changed_ = false;
  ++command_.seq;
  command_.ramp = 0;
  setLayers(command_, toDrivenLayers(crowd_->layers(), images_));
  send();
}

void LightController::take(const tracked_frame_t& frame) {
  player_.take(frame);
  update();
}

}  // namespace lab::runner
