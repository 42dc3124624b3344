#include "common/experiment/program_messages.hpp"

#include <cstdint>

#include "common/files/experiment_error.hpp"
#include "common/programs/program_file.hpp"

namespace lab {

program_id_t toId(const Program& program) {
  program_id_t id{};
  id.hash = program.hash;
  id.name = program.name;
  return id;
}

program_t toMessage(const Program& program) {
  program_t message{};
  message.id = toId(program);
  message.text = program.text;
  message.code = program.code;
  message.size = static_cast<std::int16_t>(program.code.size());
  for (const ProgramParameter& parameter : program.parameters) {
    parameter_t one{};
    one.name = parameter.name;
    one.value = parameter.value;
    one.unit = parameter.unit;
    message.parameters.push_back(one);
  }
  message.num_parameters = static_cast<std::int16_t>(message.parameters.size());
  return message;
}

Program toProgram(const program_t& message) {
  if (message.id.hash == 0) return {};
  const std::string name = "program " + message.id.name;
  Program program = toProgram(readProgram(message.text, name, message.id.name, kWidestWheels));
  if (program.hash != message.id.hash) {
    throw ExperimentError({name + ": found a text that does not compile to its byte code, allowed "
                                  "programs of this version of the lab"});
  }
  return program;
}

const Program* findProgram(const Experiment& experiment, const program_id_t& id) {
  for (const auto& [name, program] : experiment.programs) {
    if (program.hash == id.hash) return &program;
  }
  return nullptr;
}

std::string programName(const Experiment& experiment, const program_id_t& id) {
  if (const Program* program = findProgram(experiment, id)) return program->name;
  return id.hash == 0 && id.name.empty() ? kStanding : id.name;
}

}  // namespace lab
