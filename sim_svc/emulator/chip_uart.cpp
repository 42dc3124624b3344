#include "sim_svc/emulator/chip_uart.hpp"

#include <algorithm>
#include <cmath>

namespace lab::emulator {
namespace {

constexpr unsigned kBitsPerByte = 10;

}  // namespace

void ChipUart::receive(LineByte byte, std::uint64_t now) {
  line_free_ = std::max(line_free_, static_cast<double>(now)) + kBitsPerByte * line_bit_cycles_;
  arriving_.push_back({line_free_, byte});
}

std::optional<std::uint64_t> ChipUart::nextArrival() const {
  if (arriving_.empty()) return std::nullopt;
  return static_cast<std::uint64_t>(std::ceil(arriving_.front().end));
}

std::optional<LineByte> ChipUart::takeArrived(std::uint64_t now) {
  if (arriving_.empty() || arriving_.front().end > static_cast<double>(now)) return std::nullopt;
  const LineByte byte = arriving_.front().byte;
  arriving_.pop_front();
  return byte;
}

std::uint64_t ChipUart::receivingUntil() const {
  return static_cast<std::uint64_t>(std::ceil(line_free_));
}

void ChipUart::send(std::uint8_t value, std::uint64_t now) {
  transmitter_free_ =
      std::max(now, transmitter_free_) + kBitsPerByte * std::max<std::uint64_t>(1, bit_cycles_);
  sent_.push_back({transmitter_free_, value});
}

void ChipUart::cutOff(std::uint64_t now) {
  std::erase_if(sent_, [now](const SentByte& byte) { return byte.cycle > now; });
  transmitter_free_ = now;
}

std::vector<SentByte> ChipUart::takeSent(std::uint64_t until) {
  std::vector<SentByte> taken;
  while (!sent_.empty() && sent_.front().cycle <= until) {
    taken.push_back(sent_.front());
    sent_.pop_front();
  }
  return taken;
}

}  // namespace lab::emulator
