// The serial line of a Chip: its transmitter and receiver.
#include <algorithm>
#include <cmath>

#include "sim_svc/emulator/chip_simavr.hpp"
#include "sim_svc/emulator/registers.hpp"

namespace lab::emulator {
namespace {

constexpr unsigned kReceiverDepth = 2;

}  // namespace

void Chip::Simavr::onSent(avr_irq_t*, std::uint32_t value, void* object) {
  Chip& chip = chipOf(object);
  chip.transmitter_free_ = std::max(chip.cycle(), chip.transmitter_free_) +
                           10 * std::max<std::uint64_t>(1, chip.bit_cycles_);
  chip.sent_.push_back({chip.transmitter_free_, static_cast<std::uint8_t>(value)});
  ++chip.counts_.bytes_sent;
}

avr_cycle_count_t Chip::Simavr::onArrival(avr_t* avr, avr_cycle_count_t, void* object) {
  Chip& chip = chipOf(object);
  const double now = static_cast<double>(chip.cycle());
  while (!chip.arriving_.empty() && chip.arriving_.front().end <= now) {
    const LineByte byte = chip.arriving_.front().byte;
    chip.arriving_.pop_front();
    chip.deliver(byte);
  }
  if (chip.arriving_.empty()) {
    return 0;
  }
  const auto next = static_cast<std::uint64_t>(std::ceil(chip.arriving_.front().end));
  return std::max(next - chip.offset_, avr->cycle + 1);
}

void Chip::receive(LineByte byte) {
  line_free_ = std::max(line_free_, static_cast<double>(now_)) + 10 * line_bit_cycles_;
  arriving_.push_back({line_free_, byte});
  if (arriving_.size() == 1 && power_ == ChipPower::kRunning) {
    armReceiver();
  }
}

void Chip::receive(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    receive(LineByte{byte, false});
  }
}

std::uint64_t Chip::receivingUntil() const {
  return static_cast<std::uint64_t>(std::ceil(line_free_));
}

void Chip::armReceiver() {
  if (arriving_.empty()) {
    return;
  }
  const auto end = static_cast<std::uint64_t>(std::ceil(arriving_.front().end));
  avr_cycle_timer_register(simavr_->avr, end > cycle() ? end - cycle() : 1, Simavr::onArrival,
                           this);
}

/// A byte whose stop bit has just ended. simavr would begin to receive it now.
void Chip::deliver(LineByte byte) {
  avr_uart_t* uart = simavr_->uart;
  if (avr_regbit_get(simavr_->avr, uart->rxen) == 0) {
    return;
  }
  if (simavr_->waiting() >= kReceiverDepth) {
    ++counts_.bytes_overrun;
    avr_regbit_set(simavr_->avr, uart->dor);
    return;
  }
  ++counts_.bytes_received;
  const auto cycles_per_byte = uart->cycles_per_byte;
  uart->cycles_per_byte = 1;
  avr_raise_irq(uart->io.irq + UART_IRQ_INPUT,
                byte.value | (byte.framing_error ? static_cast<std::uint32_t>(UART_INPUT_FE) : 0U));
  uart->cycles_per_byte = cycles_per_byte;
}

/// simavr counts a parity bit that is not there, and only when the divider is written.
void Chip::updateBaud() {
  const Simavr& s = *simavr_;
  const std::uint64_t divider =
      1U + (s.data(kUbrr0Low) | (static_cast<std::uint64_t>(s.data(kUbrr0High) & 0x0FU) << 8U));
  bit_cycles_ = divider * ((s.data(kUcsr0A) & kU2x0) != 0 ? 8U : 16U);
  s.uart->cycles_per_byte = 10 * bit_cycles_;
}

double Chip::baud() const {
  return bit_cycles_ == 0 ? 0 : kChipHz / static_cast<double>(bit_cycles_);
}

std::vector<SentByte> Chip::takeSent(std::uint64_t until) {
  std::vector<SentByte> taken;
  while (!sent_.empty() && sent_.front().cycle <= until) {
    taken.push_back(sent_.front());
    sent_.pop_front();
  }
  return taken;
}

}  // namespace lab::emulator
