#pragma once

#include <stdint.h>

namespace lab {
namespace dynamics {

/// The bytes of a program.
struct ProgramBytes {
  const uint8_t* code = nullptr;
  uint8_t size = 0;  ///< 0: there is no such program.
};

/// Where a robot finds its programs: on the chip in the EEPROM, on a host in memory. It returns
/// only programs that checkByteCode() accepts.
class ProgramSource {
 public:
  /// The program with this hash. The bytes stay where they are until the next call.
  virtual ProgramBytes find(uint32_t hash) = 0;

 protected:
  ~ProgramSource() = default;
};

}  // namespace dynamics
}  // namespace lab
