#include "dashboard/views/run_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "common/experiment/experiment_file.hpp"
#include "common/experiment/program_colours.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/experiment/script_plan.hpp"
#include "common/math/units.hpp"
#include "common/process/version.hpp"
#include "common/text/format.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace {

const char* bodyName(Body body) {
  switch (body) {
    case Body::kSim:
      return "sim";
    case Body::kSerial:
      return "serial";
    case Body::kFirmware:
      return "firmware";
    case Body::kReplay:
      return "replay";
    case Body::kWire:
      return "wire";
  }
  return "";
}

/// "epsilon" as "ε".
std::string greek(std::string name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kLetters{{{"epsilon", "ε"},
                                                                                   {"omega", "ω"},
                                                                                   {"gamma", "γ"},
                                                                                   {"eta", "η"},
                                                                                   {"tau_", "τ"},
                                                                                   {"tau", "τ"}}};
  for (const auto& [word, letter] : kLetters) {
    if (name.starts_with(word)) return name.replace(0, word.size(), letter);
  }
  return name;
}

std::string parameters(const Program& program) {
  std::string text;
  for (const ProgramParameter& parameter : program.parameters) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", greek(parameter.name),
                        quantityText(parameter.value, parameter.unit, 4));
  }
  return text;
}

Json programsJson(const Experiment& experiment) {
  Json programs = Json::array();
  for (const auto& [name, program] : experiment.programs) {
    programs.push_back({{"name", name},
                        {"description", program.description},
                        {"text", parameters(program)},
                        {"color", programPlace(experiment, name)},
                        {"rgb", hexText(programColour(experiment, name))}});
  }
  return programs;
}

Json scriptJson(const Experiment& experiment) {
  Json script = Json::array();
  for (const LightStep& step : experiment.light.steps) {
    script.push_back({{"label", step.label},
                      {"at_s", number(step.at)},
                      {"ramp_s", number(step.ramp)},
                      {"until", step.until.given() ? conditionText(step.until) : ""}});
  }
  return script;
}

}  // namespace

void RunInfo::set(const Experiment& experiment, const std::string& run) {
  use(experiment, writeExperiment(experiment));
  run_ = run;
  version_ = kVersion;
}

void RunInfo::use(Experiment experiment, std::string text) {
  names_.clear();
  hashes_.clear();
  for (const auto& [name, program] : experiment.programs) {
    names_.push_back(name);
    hashes_.push_back(program.hash);
  }
  experiment_ = std::move(experiment);
  text_ = std::move(text);
  trouble_.clear();
}

RunInfo::RunChange RunInfo::take(const experiment_event_t& start) {
  const bool other = start.sender != runner_ || start.instance != instance_;
  const bool first = runner_.empty();
  if (!other && start.text == text_) return RunChange::kNone;
  runner_ = start.sender;
  instance_ = start.instance;
  version_ = start.version;
  if (start.text != text_) {
    try {
      use(parseExperiment(start.text, "experiment of the run"), start.text);
    } catch (const ExperimentError& error) {
      experiment_.reset();
      names_.clear();
      hashes_.clear();
      text_ = start.text;
      trouble_ = error.what();
    }
  }
  return first ? RunChange::kFirst : RunChange::kOtherRun;
}

void RunInfo::setRun(const std::string& run, bool replay) {
  run_ = run;
  replay_ = replay;
}

const Experiment& RunInfo::experiment() const {
  static const Experiment kDefault{};
  return experiment_ ? *experiment_ : kDefault;
}

int RunInfo::indexOf(const program_id_t& program) const {
  const auto found = std::ranges::find(hashes_, program.hash);
  return found == hashes_.end() ? -1 : static_cast<int>(found - hashes_.begin());
}

std::string RunInfo::json() const {
  const Experiment& e = experiment();
  Json robots = Json::array();
  for (const RobotSpec& robot : e.robots) {
    robots.push_back({{"id", robot.id}, {"body", bodyName(robot.body)}});
  }
  Json bands = Json::array();
  for (const LightBand& band : e.light_table.bands) {
    bands.push_back(
        {{"low", number(band.low)}, {"high", number(band.high)}, {"program", band.program}});
  }
  return toText({{"run", run_},
                 {"name", e.name},
                 {"description", e.description},
                 {"version", version_},
                 {"replay", replay_},
                 {"arena_cm", {number(cm(e.arena_width)), number(cm(e.arena_height))}},
                 {"robot_diameter_cm", number(cm(e.hardware.diameter))},
                 {"duration_s", number(e.duration)},
                 {"robots", std::move(robots)},
                 {"programs", programsJson(e)},
                 {"bands", std::move(bands)},
                 {"script", scriptJson(e)},
                 {"file", text_}});
}

}  // namespace lab::dashboard
