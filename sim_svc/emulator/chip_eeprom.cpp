// The EEPROM of a Chip.
#include <algorithm>

#include "common/math/random.hpp"
#include "sim_svc/emulator/chip_simavr.hpp"
#include "sim_svc/emulator/registers.hpp"

namespace lab::emulator {
namespace {

constexpr std::uint64_t kEepromWriteCycles = 27200;  // 3.4 ms

}  // namespace

avr_cycle_count_t Chip::Simavr::onEepromWritten(avr_t*, avr_cycle_count_t, void* object) {
  Simavr& self = *chipOf(object).simavr_;
  self.writing_eeprom = false;
  self.data(kEecr) = static_cast<std::uint8_t>(self.data(kEecr) & ~kEepe);
  return 0;
}

std::vector<std::uint8_t> Chip::eeprom() const {
  return {simavr_->eeprom->eeprom, simavr_->eeprom->eeprom + kEepromSize};
}

void Chip::loadEeprom(std::span<const std::uint8_t> bytes) {
  const std::size_t size = std::min<std::size_t>(bytes.size(), kEepromSize);
  std::fill_n(simavr_->eeprom->eeprom, kEepromSize, std::uint8_t{0xFF});
  std::copy_n(bytes.begin(), size, simavr_->eeprom->eeprom);
}

/// Called at every access to EECR. simavr stores at once and is ready at once; the chip says "busy"
/// in bit EEPE for 3.4 ms.
void Chip::watchEeprom(std::uint32_t value) {
  Simavr& s = *simavr_;
  if (s.writing_eeprom || (value & (kEepe | kEempe)) != (kEepe | kEempe)) {
    return;
  }
  s.writing_eeprom = true;
  ++counts_.eeprom_writes;
  s.data(kEecr) = static_cast<std::uint8_t>(s.data(kEecr) | kEepe);
  avr_cycle_timer_register(s.avr, kEepromWriteCycles, Simavr::onEepromWritten, this);
  if (cut_in_write_ > 0 && --cut_in_write_ == 0) {
    const std::size_t address =
        (s.data(kEearLow) | (static_cast<std::size_t>(s.data(kEearHigh)) << 8U)) % kEepromSize;
    Random random(settings_.seed, address);
    s.eeprom->eeprom[address] = static_cast<std::uint8_t>(random.next());
    power_cut_ = true;
    s.avr->run_cycle_count = 1;  // leave the simulator after this instruction
  }
}

}  // namespace lab::emulator
