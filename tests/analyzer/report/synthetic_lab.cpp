#include "tests/analyzer/report/synthetic_lab.hpp"

#include <algorithm>
#include <lab/clock_t.hpp>
#include <lab/experiment_command_t.hpp>
#include <lab/experiment_event_t.hpp>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/fingerprints.hpp"
#include "common/bus/message_header.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/math/units.hpp"
#include "common/process/version.hpp"
#include "tests/analyzer/report/synthetic_robot.hpp"
#include "tests/support/programs.hpp"

namespace lab::report {
namespace {

constexpr std::int64_t kLightLatency_us = 17'000;
constexpr int kCopies = 3;

}  // namespace

NamedProgram paperAbp() { return {"abp", test::abp(0.03, 0.5, 3)}; }
NamedProgram paperBp() { return {"bp", test::bp(0.07, 0.2)}; }
NamedProgram paperRtp() { return {"rtp", test::rtp(0.05, 1, 0.5)}; }

Experiment syntheticExperiment(int robots, double duration, double fps,
                               const std::vector<NamedProgram>& programs, double step) {
  Experiment experiment;
  experiment.name = "synthetic";
  experiment.seed = 7;
  experiment.duration = duration;
  experiment.camera.fps = fps;
  experiment.hardware.status_rate = fps;
  for (int id = 1; id <= robots; ++id) {
    experiment.robots.emplace_back();
    experiment.robots.back().id = id;
  }
  const auto count = static_cast<double>(programs.size());
  for (std::size_t i = 0; i < programs.size(); ++i) {
    const double low = static_cast<double>(i) / count;
    experiment.programs[programs[i].name] = programs[i].program;
    experiment.programs[programs[i].name].name = programs[i].name;
    experiment.light_table.bands.push_back(
        {low, i + 1 == programs.size() ? 1 : low + 1 / count, programs[i].name});
    LightStep one;
    one.at = static_cast<double>(i) * step;
    one.label = "light for " + programs[i].name;
    one.layers.push_back({});
    one.layers.back().intensity = low + 0.5 / count;
    experiment.light.steps.push_back(one);
  }
  experiment.light.length = count * step;
  experiment.light.repeat = programs.size() > 1;
  return experiment;
}

SyntheticLab::SyntheticLab(const std::filesystem::path& log, Experiment experiment, Keeps keeps)
    : experiment_(std::move(experiment)), bus_([this] { return loop_.now(); }), writer_(log) {
  loop_.drainWith([this] { bus_.deliver(); });
  bus_.subscribeAll([this, keeps = std::move(keeps)](const Packet& packet) {
    const auto header = peekHeader(packet.data);
    const bool is_dead = std::any_of(killed_.begin(), killed_.end(), [&](const auto& node) {
      return header && header->sender == node->identity().name &&
             header->instance == node->identity().instance;
    });
    if (!is_dead && (!keeps || keeps(packet))) writer_.write(packet);
  });
  const auto node = [this](const char* name, std::int8_t origin) {
    return std::make_unique<Node>(bus_, loop_, NodeIdentity{name, origin, 1});
  };
  runner_ = node("lab", robot_state_t::UNKNOWN);
  projector_ = node("projector_ctl", robot_state_t::SIM);
  simulation_ = node("sim_svc", robot_state_t::SIM);
  for (const RobotSpec& robot : experiment_.robots) {
    robots_.push_back(std::make_unique<SyntheticRobot>(robot.id, experiment_, 1));
  }
}

SyntheticLab::~SyntheticLab() = default;

void SyntheticLab::run() {
  begin();
  runUntil(experiment_.duration);
  end();
}

void SyntheticLab::begin() {
  for (Node* node : {runner_.get(), projector_.get(), simulation_.get()}) {
    node->start();
    node->ready();
  }
  experiment_event_t start{};
  start.kind = experiment_event_t::START;
  start.text = writeExperiment(experiment_);
  start.contract_version = kContractVersion;
  start.fingerprints = fingerprintList();
  start.version = kVersion;
  for (int i = 0; i < kCopies; ++i) runner_->publish(channels::kExperimentEvent, start);
  const auto period = units::microseconds(1 / experiment_.camera.fps);
  loop_.every(period, loop_.now() + period, [this] { tick(); });
  loop_.every(100'000, loop_.now() + 100'000, [this] { publishLight(false); });
  loop_.every(1'000'000, loop_.now(), [this] {
    clock_t clock{};
    runner_->publish(channels::kClock, clock);
  });
  showStep(0);
}

void SyntheticLab::runUntil(double seconds) {
  loop_.runUntil(VirtualLoop::kEpoch + units::microseconds(seconds));
}

void SyntheticLab::end() {
  publishEvent(experiment_event_t::END, "the script is over");
  for (Node* node : {simulation_.get(), projector_.get(), runner_.get()}) node->close();
  bus_.deliver();
}

void SyntheticLab::showStep(std::size_t number) {
  const auto& steps = experiment_.light.steps;
  const std::size_t round = number / steps.size();
  const double at =
      steps[number % steps.size()].at + static_cast<double>(round) * experiment_.light.length;
  if (at >= experiment_.duration || (round > 0 && !experiment_.light.repeat)) return;
  loop_.at(VirtualLoop::kEpoch + units::microseconds(at), [this, number] {
    const std::int64_t commanded = loop_.now();
    loop_.at(commanded + kLightLatency_us, [this, number, commanded] {
      step_ = number % experiment_.light.steps.size();
      step_utime_ = loop_.now();
      lit_ = true;
      publishLight(true);
      const std::string& program = experiment_.light_table.bands[step_].program;
      for (auto& robot : robots_) robot->setProgram(experiment_.programs[program], loop_.now());
      experiment_event_t event{};
      event.kind = experiment_event_t::STEP;
      event.step = static_cast<std::int32_t>(number);
      event.label = experiment_.light.steps[step_].label;
      event.commanded_utime = commanded;
      event.presented_utime = loop_.now();
      event.first_acted_utime = loop_.now() + 21'000;
      event.last_acted_utime = loop_.now() + 38'000;
      event.robots_acted = event.robots_expected = static_cast<std::int32_t>(robots_.size());
      for (int i = 0; i < kCopies; ++i) runner_->publish(channels::kExperimentEvent, event);
      showStep(number + 1);
    });
  });
}

void SyntheticLab::publishLight(bool changed) {
  if (!lit_) return;
  light_status_t status{};
  status.utime = loop_.now();
  status.commander = "lab";
  status.label = experiment_.light.steps[step_].label;
  status.first_shown_utime = step_utime_;
  status.moving = changed ? 1 : 0;
  status.mix = 1;
  status.layers = toMessages(experiment_.light.steps[step_].layers);
  status.num_layers = static_cast<std::int32_t>(status.layers.size());
  projector_->publish(channels::kLightStatus, status);
}

void SyntheticLab::tick() {
  robot_status_t status{};
  tracked_frame_t frame{};
  for (auto& robot : robots_) {
    robot->advance(1 / experiment_.camera.fps, loop_.now());
    status.robots.push_back(robot->state(loop_.now()));
    frame.robots.push_back(robot->pose());
  }
  status.num_robots = frame.num_robots = static_cast<std::int32_t>(robots_.size());
  frame.origin = robot_state_t::SIM;
  frame.frame = ++frame_;
  frame.frame_period = 1 / experiment_.camera.fps;
  simulation_->publish(channels::kTrackedFrame, frame);
  simulation_->publish(channels::kRobotStatus, status);
}

void SyntheticLab::restartSimulation() {
  const std::int64_t instance = simulation_->identity().instance + 1;
  bus_.deliver();
  killed_.push_back(std::move(simulation_));
  simulation_ =
      std::make_unique<Node>(bus_, loop_, NodeIdentity{"sim_svc", robot_state_t::SIM, instance});
  simulation_->start();
  simulation_->ready();
  for (auto& robot : robots_) {
    const std::int32_t id = robot->pose().robot_id;
    robot = std::make_unique<SyntheticRobot>(id, experiment_, instance);
    const std::string& program = experiment_.light_table.bands[step_].program;
    robot->setProgram(experiment_.programs[program], loop_.now());
  }
  frame_ = 0;
}

void SyntheticLab::publishEvent(std::int8_t kind, const std::string& text) {
  experiment_event_t event{};
  event.kind = kind;
  event.text = text;
  event.utime = loop_.now();
  for (int i = 0; i < kCopies; ++i) runner_->publish(channels::kExperimentEvent, event);
}

void SyntheticLab::fault(const std::string& text) { publishEvent(experiment_event_t::FAULT, text); }
void SyntheticLab::markByHand(const std::string& text) {
  Node node(bus_, loop_, {"lab_mark", robot_state_t::UNKNOWN, loop_.now()});
  experiment_command_t wish{};
  wish.action = experiment_command_t::MARK;
  wish.text = text;
  wish.seq = 1;
  for (int asked = 0; asked < 2; ++asked) node.publishCommand(channels::kExperimentCommand, wish);
  node.close();
}

void SyntheticLab::mark(const std::string& text) { publishEvent(experiment_event_t::MARK, text); }

}  // namespace lab::report
