/// How often a program of motion begins a hold.
#pragma once

#include "common/programs/program.hpp"

namespace lab {

/// The mean number of holds per second, from an execution of at most 10000 holds and 1000 s in
/// which all sensors read 0 [1/s].
[[nodiscard]] double holdsPerSecond(const Program& program);

}  // namespace lab
