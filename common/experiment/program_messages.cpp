#include "common/experiment/program_messages.hpp"

#include <tuple>

namespace lab {
namespace {

static_assert(program_t::NONE == dynamics::kNone && program_t::ABP == dynamics::kAbp &&
              program_t::NOISY_ABP == dynamics::kNoisyAbp && program_t::BP == dynamics::kBp &&
              program_t::RTP == dynamics::kRtp && program_t::WHEELS == dynamics::kWheels);

auto parameters(const program_t& program) {
  return std::tie(program.kind, program.v, program.va, program.V, program.epsilon, program.eta,
                  program.gamma, program.tau_t, program.wheel_left, program.wheel_right);
}

}  // namespace

program_t toMessage(const dynamics::RobotProgram& program) {
  program_t message{};
  message.kind = static_cast<std::int8_t>(program.kind);
  message.v = program.v;
  message.va = program.va;
  message.V = program.V;
  message.epsilon = program.epsilon;
  message.eta = program.eta;
  message.gamma = program.gamma;
  message.tau_t = program.tau_t;
  message.wheel_left = program.wheel_left;
  message.wheel_right = program.wheel_right;
  return message;
}

dynamics::RobotProgram toProgram(const program_t& message) {
  dynamics::RobotProgram program;
  const bool defined = message.kind >= 0 && message.kind < dynamics::kProgramKinds;
  program.kind = defined ? static_cast<dynamics::ProgramKind>(message.kind) : dynamics::kNone;
  program.v = message.v;
  program.va = message.va;
  program.V = message.V;
  program.epsilon = message.epsilon;
  program.eta = message.eta;
  program.gamma = message.gamma;
  program.tau_t = message.tau_t;
  program.wheel_left = message.wheel_left;
  program.wheel_right = message.wheel_right;
  return program;
}

std::string programName(const Experiment& experiment, const program_t& program) {
  for (const auto& [name, spec] : experiment.programs) {
    if (sameProgram(toMessage(spec), program)) return name;
  }
  return modelName(program.kind);
}

std::string modelName(std::int8_t kind) {
  switch (kind) {
    case program_t::ABP:
      return "ABP";
    case program_t::NOISY_ABP:
      return "noisy ABP";
    case program_t::BP:
      return "BP";
    case program_t::RTP:
      return "RTP";
    case program_t::WHEELS:
      return "wheels";
    default:
      return "standing";
  }
}

bool sameProgram(const program_t& a, const program_t& b) { return parameters(a) == parameters(b); }

bool orderedBefore(const program_t& a, const program_t& b) { return parameters(a) < parameters(b); }

}  // namespace lab
