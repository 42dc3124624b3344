#include "runner/program/program_trace.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>

#include "common/programs/fixed_of.hpp"
#include "common/text/nearest_word.hpp"
#include "robot/dynamics/robot_core.hpp"
#include "robot/language/builtins.hpp"
#include "robot/language/listing.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {
namespace {

constexpr double kCounts = 1023;
constexpr std::uint32_t kLeaseMs = 2 * dynamics::kLongestHoldMs;

using dynamics::MachineInputs;
using dynamics::Rng;

class TracedSource final : public dynamics::ProgramSource {
 public:
  explicit TracedSource(const language::CompiledProgram& program) : program_(program) {}
  dynamics::ProgramBytes find(std::uint32_t /*hash*/) override {
    return {program_.code.data(), static_cast<std::uint8_t>(program_.code.size())};
  }

 private:
  const language::CompiledProgram& program_;
};

/// The position of a block: 0 is the start block, 2 p + 1 and 2 p + 2 those of phase p.
std::size_t blockBegin(std::span<const std::uint8_t> code, int block) {
  std::size_t at = 2;
  for (int i = 0; i < block; ++i) at += 1U + code[at];
  return at;
}

bool isDraw(std::uint8_t opcode) {
  return opcode >= dynamics::kUniform && opcode <= dynamics::kChoose;
}

/// What the draws of a block give: the machine executes the block up to each draw, and stores its
/// result where it can be read.
std::vector<TracedDraw> drawsOf(std::span<const std::uint8_t> code, int block,
                                const dynamics::Machine& before, const MachineInputs& inputs,
                                const Rng& rng) {
  std::vector<TracedDraw> draws;
  const std::size_t begin = blockBegin(code, block) + 1;
  const std::size_t end = begin + code[begin - 1];
  for (std::size_t at = begin; at < end;) {
    const std::uint8_t opcode = code[at];
    at += dynamics::instructionSize(opcode);
    if (!isDraw(opcode)) continue;
    std::vector<std::uint8_t> part{dynamics::kByteCodeFormat, 1, 0};
    for (std::uint8_t state = 0; state < dynamics::kStates; ++state) {
      const auto value = static_cast<std::uint32_t>(before.state(state));
      part.push_back(dynamics::kPushLong);
      for (int shift = 0; shift < 32; shift += 8) {
        part.push_back(static_cast<std::uint8_t>(value >> shift));
      }
      part.insert(part.end(), {dynamics::kStore, state});
    }
    part[2] = static_cast<std::uint8_t>(part.size() - 3);
    part.push_back(static_cast<std::uint8_t>(at - begin + 2));
    std::copy(code.begin() + static_cast<std::ptrdiff_t>(begin),
              code.begin() + static_cast<std::ptrdiff_t>(at), std::back_inserter(part));
    part.insert(part.end(), {dynamics::kStore, 0, 0});
    dynamics::Machine machine;
    Rng copy = rng;
    machine.start(part.data(), static_cast<std::uint8_t>(part.size()), inputs, copy);
    static_cast<void>(machine.next(inputs, copy));
    draws.push_back({opcode, machine.state(0)});
  }
  return draws;
}

/// An input that --set sets.
struct TraceInput {
  std::string name;
  double low = 0;
  double high = 1;
  const char* unit = "";
  std::function<void(double)> set;
};

std::vector<TraceInput> traceInputs(TraceInputs& inputs) {
  const auto counts = [](double share) {
    return static_cast<std::uint16_t>(std::lround(share * kCounts));
  };
  dynamics::Sensors& sensors = inputs.sensors;
  std::vector<TraceInput> all{
      {"light", 0, 1, "",
       [&sensors, counts](double x) { sensors.light_front = sensors.light_back = counts(x); }},
      {"light_front", 0, 1, "", [&sensors, counts](double x) { sensors.light_front = counts(x); }},
      {"light_back", 0, 1, "", [&sensors, counts](double x) { sensors.light_back = counts(x); }},
      {"battery", 0, 65.535, " volt",
       [&inputs](double x) {
         inputs.battery_mv = static_cast<std::uint16_t>(std::lround(x * 1e3));
       }},
      {"id", 0, 65535, "",
       [&inputs](double x) { inputs.id = static_cast<std::uint16_t>(std::lround(x)); }}};
  for (std::uint8_t i = 0; i < dynamics::kIrSensors; ++i) {
    all.push_back({language::inputName(static_cast<std::uint8_t>(dynamics::kIr + i)), 0, 1, "",
                   [&sensors, counts, i](double x) { sensors.ir[i] = counts(x); }});
  }
  for (std::uint8_t i = 0; i < dynamics::kSenses; ++i) {
    all.push_back({language::inputName(static_cast<std::uint8_t>(dynamics::kSense + i)),
                   -language::kLargestNumber, language::kLargestNumber, "",
                   [&inputs, i](double x) { inputs.senses[i] = fixedOf(x); }});
  }
  return all;
}

/// Follows the holds of a core from one to the next.
class Tracer {
 public:
  Tracer(const language::CompiledProgram& program, const TraceInputs& inputs, std::uint64_t seed)
      : program_(program), inputs_(inputs), source_(program), core_(source_) {
    machine_inputs_.sensors = inputs.sensors;
    machine_inputs_.battery_mv = inputs.battery_mv;
    machine_inputs_.id = inputs.id;
    core_.seed(seed);
    core_.setBattery(inputs.battery_mv);
    for (std::uint8_t i = 0; i < dynamics::kSenses; ++i) {
      core_.setSense(i, inputs.senses[i]);
      machine_inputs_.senses[i] = inputs.senses[i];
    }
    dynamics::CoreSettings settings;
    settings.light.bands[0] = {0, dynamics::kLightCounts, 0};
    settings.light.count = 1;
    settings.programs[0] = program.hash;
    settings.reversal.enabled = false;
    settings.robot_id = inputs.id;
    period_ms_ = settings.sensor_period_ms;
    scan_ms_ = period_ms_;
    core_.renewLease(0, kLeaseMs);
    core_.configure(0, settings);
  }

  std::vector<TracedHold> follow(int holds) {
    std::vector<TracedHold> traced;
    dynamics::Machine machine = core_.machine();
    Rng rng = core_.rng();
    core_.sense(0, inputs_.sensors);
    TracedHold first;
    first.start_draws = drawsOf(program_.code, 0, machine, machine_inputs_, rng);
    machine.start(program_.code.data(), static_cast<std::uint8_t>(program_.code.size()),
                  machine_inputs_, rng);
    TracedHold hold = begun(machine, rng, std::move(first));
    while (true) {
      TracedHold next;
      const bool ended = endHold(hold, next);
      hold.limited = limited_;
      traced.push_back(std::move(hold));
      if (!ended || static_cast<int>(traced.size()) >= holds) return traced;
      hold = std::move(next);
    }
  }

 private:
  /// Advances to the end of the hold. False: it has none within an hour.
  bool endHold(TracedHold& hold, TracedHold& next) {
    const std::uint32_t draws = core_.record().draw_count;
    const std::uint32_t begin_ms = core_.holdStartMs();
    core_.renewLease(begin_ms, kLeaseMs);
    while (true) {
      limited_ = (core_.flags() & dynamics::kSaturated) != 0;
      const dynamics::Machine machine = core_.machine();
      const Rng rng = core_.rng();
      const bool endless = core_.holdDurationMs() == dynamics::kEndless;
      const std::uint32_t end_ms = begin_ms + core_.holdDurationMs();
      if (!machine.canBeInterrupted()) {
        if (endless) return false;
        // A scan changes nothing in a hold without `until`.
        while (scan_ms_ < end_ms) scan_ms_ += period_ms_;
      }
      if (!endless && end_ms <= scan_ms_) {  // before the scan of the same millisecond
        now_ms_ = end_ms;
        static_cast<void>(core_.advanceOne(now_ms_));
        hold.duration_ms = now_ms_ - begin_ms;
        next = begun(machine, rng, {});
        return true;
      }
      if (scan_ms_ - begin_ms > dynamics::kLongestHoldMs) return false;
      now_ms_ = scan_ms_;
      scan_ms_ += period_ms_;
      core_.sense(now_ms_, inputs_.sensors);
      if (core_.record().draw_count == draws) continue;
      hold.duration_ms = now_ms_ - begin_ms;
      hold.interrupted = true;
      next = interruptedBy(machine, rng, begin_ms, hold);
      return true;
    }
  }

  TracedHold interruptedBy(dynamics::Machine machine, Rng rng, std::uint32_t begin_ms,
                           TracedHold& hold) {
    updateInputs();
    machine_inputs_.phase_time_ms = now_ms_ - begin_ms;
    hold.interruption_draws =
        drawsOf(program_.code, 2 * machine.phase() + 2, machine, machine_inputs_, rng);
    static_cast<void>(machine.interrupted(machine_inputs_, rng));
    return begun(machine, rng, {});
  }

  /// The hold that the core has just begun, and that the machine has not begun yet.
  TracedHold begun(const dynamics::Machine& before, const Rng& rng, TracedHold hold) {
    const dynamics::CoreReport& record = core_.record();
    hold.begin_ms = core_.holdStartMs();
    hold.phase = record.phase;
    hold.left_um_s = record.held.left;
    hold.right_um_s = record.held.right;
    for (std::size_t i = 0; i < program_.states.size(); ++i) {
      hold.states.push_back(core_.machine().state(static_cast<std::uint8_t>(i)));
    }
    updateInputs();
    hold.draws = drawsOf(program_.code, 2 * hold.phase + 1, before, machine_inputs_, rng);
    return hold;
  }

  /// What the program read when the core began the present hold.
  void updateInputs() {
    machine_inputs_.time_ms = now_ms_;
    machine_inputs_.phase_time_ms = 0;
    machine_inputs_.heading_turns = core_.odometry().headingTurns();
    machine_inputs_.distance_um = core_.odometry().distanceUm();
  }

  const language::CompiledProgram& program_;
  const TraceInputs& inputs_;
  TracedSource source_;
  dynamics::RobotCore core_;
  MachineInputs machine_inputs_;
  std::uint32_t period_ms_ = 0;
  std::uint32_t now_ms_ = 0;
  std::uint32_t scan_ms_ = 0;  ///< The next scan of the sensors.
  bool limited_ = false;
};

std::string drawText(const TracedDraw& draw) {
  const std::string name = language::instructionName(draw.opcode);
  if (draw.opcode == dynamics::kChance || draw.opcode == dynamics::kChanceOf) {
    return std::string("chance ") + (draw.result != 0 ? "yes" : "no");
  }
  return fmt::format("{} {:.5g}", name, draw.result / static_cast<double>(dynamics::kOne));
}

void addDraws(std::vector<std::string>& texts, const char* before,
              const std::vector<TracedDraw>& draws) {
  for (const TracedDraw& draw : draws) texts.push_back(before + drawText(draw));
}

}  // namespace

std::vector<TracedHold> traceHolds(const language::CompiledProgram& program,
                                   const TraceInputs& inputs, std::uint64_t seed, int holds) {
  return Tracer(program, inputs, seed).follow(holds);
}

std::string traceTable(const language::CompiledProgram& program,
                       const std::vector<TracedHold>& holds) {
  std::string text =
      fmt::format("{:>10} {:>12} {:>11} {:>12} {:>12} {:>10} {:>7}", "t (s)", "phase",
                  "left (cm/s)", "right (cm/s)", "turn (rad/s)", "hold (s)", "ended");
  for (const std::string& state : program.states) text += fmt::format(" {:>10}", state);
  text += "  draws\n";
  const auto out = std::back_inserter(text);
  std::size_t limited = 0;
  for (const TracedHold& hold : holds) {
    const double turn =
        (hold.right_um_s - hold.left_um_s) * 1e-6 / dynamics::WheelLimits().wheel_base;
    fmt::format_to(out, "{:10.3f} {:>12} {:11.4f} {:12.4f} {:12.4f} {:>10} {:>7}",
                   hold.begin_ms / 1e3, program.phases[hold.phase].name, hold.left_um_s / 1e4,
                   hold.right_um_s / 1e4, turn,
                   hold.duration_ms ? fmt::format("{:.3f}", *hold.duration_ms / 1e3) : "forever",
                   hold.interrupted ? "until" : "");
    for (const dynamics::Fixed state : hold.states) {
      fmt::format_to(out, " {:10.4f}", state / static_cast<double>(dynamics::kOne));
    }
    std::vector<std::string> draws;
    addDraws(draws, "state: ", hold.start_draws);
    addDraws(draws, "", hold.draws);
    addDraws(draws, "until: ", hold.interruption_draws);
    fmt::format_to(out, "  {}\n", draws.empty() ? "-" : fmt::format("{}", fmt::join(draws, ", ")));
    limited += hold.limited ? 1U : 0U;
  }
  if (limited > 0) {
    fmt::format_to(out, "in {} of {} holds a wheel speed, a result or the hold was limited\n",
                   limited, holds.size());
  }
  return text;
}

void setInput(TraceInputs& inputs, std::string_view setting) {
  const std::size_t equals = setting.find('=');
  const std::string name(setting.substr(0, equals));
  std::vector<TraceInput> known = traceInputs(inputs);
  const auto input = std::ranges::find(known, name, &TraceInput::name);
  if (equals == std::string_view::npos || input == known.end()) {
    std::vector<std::string> names;
    for (const TraceInput& one : known) names.push_back(one.name);
    throw UserError(fmt::format(
        "--set: found {}, expected NAME=VALUE with one of light (both sensors), light_front, "
        "light_back, ir(0) to ir({}), sense(0) to sense({}), battery, id{}",
        setting, dynamics::kIrSensors - 1, dynamics::kSenses - 1, didYouMean(name, names)));
  }
  const std::string_view text = setting.substr(equals + 1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = end == text.data() + text.size();
  if (error != std::errc() || !whole || !(value >= input->low && value <= input->high)) {
    throw UserError(fmt::format("--set: found {}, expected {}=VALUE from {} to {}{}", setting, name,
                                input->low, input->high, input->unit));
  }
  input->set(value);
}

}  // namespace lab::runner
