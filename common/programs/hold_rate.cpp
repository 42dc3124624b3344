#include "common/programs/hold_rate.hpp"

#include <cstdint>

#include "robot/dynamics/machine.hpp"

namespace lab {

double holdsPerSecond(const Program& program) {
  constexpr int kMostHolds = 10000;
  constexpr std::uint64_t kLongest_ms = 1'000'000;
  dynamics::Machine machine;
  dynamics::MachineInputs inputs;
  dynamics::Rng rng;
  rng.seed(1);
  machine.start(program.code.data(), static_cast<std::uint8_t>(program.code.size()), inputs, rng);
  std::uint64_t time_ms = 0;
  int holds = 0;
  while (holds < kMostHolds && time_ms < kLongest_ms) {
    const dynamics::PhaseResult result = machine.next(inputs, rng);
    ++holds;
    if (result.duration_ms == dynamics::kEndless) return 0;
    time_ms += result.duration_ms;
    inputs.time_ms = static_cast<std::uint32_t>(time_ms);
  }
  return time_ms == 0 ? 0 : holds * 1e3 / static_cast<double>(time_ms);
}

}  // namespace lab
