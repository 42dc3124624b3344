// Programs of motion: texts, which the compiler refuses or translates to byte code that the checker
// accepts; and byte code, which is refused or executed within its bound. Byte code begins with its
// format number, which no text does.
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "common/files/experiment_error.hpp"
#include "common/programs/hold_rate.hpp"
#include "common/programs/program_file.hpp"
#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/machine.hpp"
#include "tests/fuzz/input.hpp"

namespace lab::fuzz {
namespace {

void execute(const std::vector<std::uint8_t>& code) {
  constexpr int kHolds = 200;
  dynamics::Rng rng;
  rng.seed(code.size());
  dynamics::MachineInputs inputs;
  dynamics::Machine machine;
  machine.start(code.data(), static_cast<std::uint8_t>(code.size()), inputs, rng);
  int without_time = 0;
  for (int i = 0; i < kHolds; ++i) {
    const std::uint32_t bits = rng.next();
    inputs.sensors.light_front = bits & 1023U;
    inputs.sensors.ir[bits % dynamics::kIrSensors] = bits >> 10U & 1023U;
    inputs.heading_turns = bits;
    inputs.senses[bits % dynamics::kSenses] = static_cast<dynamics::Fixed>(bits);
    const dynamics::PhaseResult hold = machine.next(inputs, rng);
    require(hold.duration_ms <= dynamics::kLongestHoldMs || hold.duration_ms == dynamics::kEndless);
    without_time = hold.duration_ms == 0 ? without_time + 1 : 0;
    require(without_time <= dynamics::kZeroHolds);
    static_cast<void>(machine.interrupted(inputs, rng));
  }
}

bool isValid(const std::vector<std::uint8_t>& code) {
  const auto size = static_cast<std::uint16_t>(std::min<std::size_t>(code.size(), 0xFFFF));
  return dynamics::checkByteCode(code.data(), size).fault == dynamics::kValidByteCode;
}

void compileText(const std::string& text) {
  ProgramFile file;
  try {
    file = readProgram(text, "fuzz.toml", "fuzz");
  } catch (const ExperimentError&) {
    return;
  }
  const Program program = toProgram(file);
  require(isValid(program.code));
  execute(program.code);
  static_cast<void>(holdsPerSecond(program));
  require(readProgram(program.text, "written.toml", "fuzz").text == file.text);
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size > 0 && bytes[0] == lab::dynamics::kByteCodeFormat) {
    const std::vector<std::uint8_t> code(bytes, bytes + size);
    if (lab::fuzz::isValid(code)) lab::fuzz::execute(code);
  } else {
    lab::fuzz::compileText(lab::fuzz::Input(bytes, size).restAsText());
  }
  return 0;
}
