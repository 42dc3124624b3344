#include "robot/dynamics/exponential.hpp"

#include "robot/dynamics/flash.hpp"

namespace lab {
namespace dynamics {
namespace {

// log2(1 + i / 128) in units of 2^-16, i = 0..127. tableEntry() adds the entry of i = 128.
const uint16_t kLog2Table[128] LAB_IN_FLASH = {
    0,     736,   1466,  2190,  2909,  3623,  4331,  5034,  5732,  6425,  7112,  7795,  8473,
    9146,  9814,  10477, 11136, 11791, 12440, 13086, 13727, 14363, 14996, 15624, 16248, 16868,
    17484, 18096, 18704, 19308, 19909, 20505, 21098, 21687, 22272, 22854, 23433, 24007, 24579,
    25146, 25711, 26272, 26830, 27384, 27936, 28484, 29029, 29571, 30109, 30645, 31178, 31707,
    32234, 32758, 33279, 33797, 34312, 34825, 35334, 35841, 36346, 36847, 37346, 37842, 38336,
    38827, 39316, 39802, 40286, 40767, 41246, 41722, 42196, 42667, 43137, 43603, 44068, 44530,
    44990, 45448, 45904, 46357, 46809, 47258, 47705, 48150, 48593, 49034, 49472, 49909, 50344,
    50776, 51207, 51636, 52063, 52488, 52911, 53332, 53751, 54169, 54584, 54998, 55410, 55820,
    56229, 56635, 57040, 57443, 57845, 58245, 58643, 59039, 59434, 59827, 60219, 60609, 60997,
    61384, 61769, 62152, 62534, 62915, 63294, 63671, 64047, 64421, 64794, 65166,
};

uint32_t tableEntry(uint8_t index) { return index < 128 ? readFlash(&kLog2Table[index]) : 65536U; }

}  // namespace

uint32_t negativeLog2(uint32_t bits) {
  uint32_t mantissa = bits | 1U;  // the loop ends because at least one bit is set
  uint32_t exponent = 1;
  while ((mantissa & 0x80000000U) == 0) {
    mantissa <<= 1;
    ++exponent;
  }
  const uint8_t index = static_cast<uint8_t>((mantissa >> 24) & 0x7FU);
  const uint32_t fraction = (mantissa >> 8) & 0xFFFFU;
  const uint32_t low = tableEntry(index);
  const uint32_t rise = tableEntry(static_cast<uint8_t>(index + 1)) - low;
  const uint32_t log2_of_mantissa = low + ((rise * fraction + 0x8000U) >> 16);
  return (exponent << 16) - log2_of_mantissa;
}

uint32_t negativeLog(uint32_t bits) {
  constexpr uint32_t kLn2 = 2977044472U;  // ln 2 in units of 2^-32
  return static_cast<uint32_t>((static_cast<uint64_t>(negativeLog2(bits)) * kLn2 + 0x80000000U) >>
                               32);
}

}  // namespace dynamics
}  // namespace lab
