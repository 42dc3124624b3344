/// Implementation of Chip that needs simavr's headers.
#pragma once

#include <simavr/avr_eeprom.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>

#include <cstdint>
#include <cstdlib>

#include "sim_svc/emulator/chip.hpp"

namespace lab::emulator {

struct Chip::Simavr {
  explicit Simavr(Chip& chip);
  ~Simavr() {
    avr_terminate(avr);
    std::free(avr);
  }
  Simavr(const Simavr&) = delete;
  Simavr& operator=(const Simavr&) = delete;

  static Chip& chipOf(avr_t* avr) { return *static_cast<Chip*>(avr->custom.data); }
  static Chip& chipOf(void* chip) { return *static_cast<Chip*>(chip); }

  std::uint8_t& data(std::uint16_t address) const { return avr->data[address]; }
  unsigned waiting() const {
    return static_cast<unsigned>((uart->input.write - uart->input.read) &
                                 (uart_fifo_fifo_size - 1));
  }

  // Called by simavr.
  static void onSleep(avr_t* avr, avr_cycle_count_t cycles);
  static void onReset(avr_t* avr);
  static void onSent(avr_irq_t*, std::uint32_t value, void* chip);
  static void onMotorRegister(avr_irq_t*, std::uint32_t, void* chip);
  static void onBaudRegister(avr_irq_t*, std::uint32_t, void* chip) { chipOf(chip).updateBaud(); }
  static void onEeprom(avr_irq_t*, std::uint32_t value, void* chip) {
    chipOf(chip).watchEeprom(value);
  }
  static avr_cycle_count_t onStop(avr_t*, avr_cycle_count_t, void*) { return 0; }
  static avr_cycle_count_t onArrival(avr_t* avr, avr_cycle_count_t, void* chip);
  static avr_cycle_count_t onSettled(avr_t* avr, avr_cycle_count_t when, void* chip);
  static avr_cycle_count_t onEepromWritten(avr_t* avr, avr_cycle_count_t, void* chip);

  void watch(std::uint16_t address, void (*callback)(avr_irq_t*, std::uint32_t, void*),
             Chip& chip) {
    avr_irq_register_notify(avr_iomem_getirq(avr, address, nullptr, AVR_IOMEM_IRQ_ALL), callback,
                            &chip);
  }

  avr_t* avr = nullptr;
  avr_uart_t* uart = nullptr;
  avr_eeprom_t* eeprom = nullptr;
  void (*core_reset)(avr_t*) = nullptr;
  bool reset_seen = false;
  bool writing_eeprom = false;
};

}  // namespace lab::emulator
