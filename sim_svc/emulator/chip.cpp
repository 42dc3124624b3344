#include "sim_svc/emulator/chip.hpp"

#include <simavr/avr_adc.h>
#include <simavr/avr_extint.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>

#include "common/math/random.hpp"
#include "sim_svc/emulator/chip_simavr.hpp"
#include "sim_svc/emulator/motor_pins.hpp"
#include "sim_svc/emulator/registers.hpp"

namespace lab::emulator {
namespace {

constexpr std::uint32_t kSupplyMv = 3300;
constexpr std::uint64_t kSettleCycles = 400;         // 50 us
constexpr std::uint64_t kEepromWriteCycles = 27200;  // 3.4 ms (ATmega328P data sheet)
constexpr unsigned kReceiverDepth = 2;               // bytes

/// Smallest voltage that the converter converts into these counts (simavr: counts = mV * 1023 /
/// 3300).
std::uint32_t millivolts(std::uint16_t counts) {
  return (std::min<std::uint32_t>(counts, 1023) * kSupplyMv + 1022) / 1023;
}

template <class Module>
Module* findModule(avr_t* avr, const char* kind) {
  for (avr_io_t* io = avr->io_port; io != nullptr; io = io->next) {
    if (std::strcmp(io->kind, kind) == 0) {
      return reinterpret_cast<Module*>(io);
    }
  }
  throw FirmwareImageError(std::string("this libsimavr's ATmega328P has no ") + kind);
}

}  // namespace

Chip::Simavr::Simavr(Chip& chip) {
  avr = avr_make_mcu_by_name("atmega328p");
  if (avr == nullptr) {
    throw FirmwareImageError("this libsimavr does not support the ATmega328P");
  }
  avr_init(avr);
  avr->custom.data = &chip;
  avr->frequency = static_cast<std::uint32_t>(kChipHz);
  avr->vcc = avr->avcc = avr->aref = kSupplyMv;
  avr->sleep = onSleep;  // replaces simavr's real-time sleep
  core_reset = avr->reset;
  avr->reset = onReset;

  const FirmwareImage& program = *chip.program_;
  std::copy(program.flash().begin(), program.flash().end(), avr->flash + program.flashBase());
  avr->codeend = program.flashBase() + static_cast<std::uint32_t>(program.flash().size());

  uart = findModule<avr_uart_t>(avr, "uart");
  eeprom = findModule<avr_eeprom_t>(avr, "eeprom");
  avr_irq_register_notify(uart->io.irq + UART_IRQ_OUTPUT, onSent, &chip);
  for (const std::uint16_t address : {kPortB, kDdrB, kPortD, kDdrD, kTccr0A, kOcr0A, kOcr0B}) {
    watch(address, onMotorRegister, chip);
  }
  watch(kUbrr0Low, onBaudRegister, chip);
  watch(kUcsr0A, onBaudRegister, chip);
  watch(kEecr, onEeprom, chip);
}

/// Called before simavr adds `cycles` + 1 to its cycle count: a sleep ends one cycle after the
/// timer that ends it. If onStop ends the sleep one cycle before another timer, that timer would
/// come one cycle earlier than without the stop. Skipping a cycle keeps its time independent of the
/// stop.
void Chip::Simavr::onSleep(avr_t* avr, avr_cycle_count_t cycles) {
  const avr_cycle_timer_slot_t* first = avr->cycle_timers.timer;
  if (first != nullptr && first->timer == onStop && first->next != nullptr &&
      first->next->when == first->when + 1) {
    ++avr->cycle;
  }
  chipOf(avr).counts_.cycles_asleep += cycles + 1;
}

void Chip::Simavr::onReset(avr_t* avr) {
  Simavr& self = *chipOf(avr).simavr_;
  self.reset_seen = true;
  if (self.core_reset != nullptr) {
    self.core_reset(avr);
  }
}

void Chip::Simavr::onMotorRegister(avr_irq_t*, std::uint32_t, void* object) {
  Chip& chip = chipOf(object);
  const bool emitters = emittersOn(chip.simavr_->avr->data);
  if (emitters != chip.emitters_on_) {
    chip.emitters_on_ = emitters;
    chip.applyInputs();
  }
  if (!chip.settling_) {
    chip.settling_ = true;
    avr_cycle_timer_register(chip.simavr_->avr, kSettleCycles, onSettled, object);
  }
}

avr_cycle_count_t Chip::Simavr::onSettled(avr_t*, avr_cycle_count_t when, void* object) {
  Chip& chip = chipOf(object);
  chip.settling_ = false;
  chip.recordDuty(when + chip.offset_);
  return 0;
}

Chip::Chip(std::shared_ptr<const FirmwareImage> program, const ChipSettings& settings)
    : program_(std::move(program)), settings_(settings), simavr_(std::make_unique<Simavr>(*this)) {
  setLineBaud(settings.line_baud);
}

Chip::~Chip() = default;

std::uint64_t Chip::cycle() const { return simavr_->avr->cycle + offset_; }

void Chip::switchOn() {
  if (power_ != ChipPower::kOff) {
    return;
  }
  Random random(settings_.seed, starts_);
  for (std::uint16_t address = kRamBegin; address <= kRamLast; ++address) {
    simavr_->data(address) = static_cast<std::uint8_t>(random.next());
  }
  start(ResetSource::kPowerOn);
}

void Chip::switchOff() {
  if (power_ != ChipPower::kOff) {
    halt(ChipPower::kOff);
  }
}

void Chip::reset(std::uint64_t held_cycles) {
  if (power_ == ChipPower::kOff) {
    return;
  }
  ++counts_.resets;
  halt(ChipPower::kHeld);
  held_until_ = cycle() + held_cycles;
}

/// The pins float, so the motors stand, and a transmission is cut off.
void Chip::halt(ChipPower power) {
  power_ = power;
  const std::uint64_t now = cycle();
  uart_.cutOff(now);
  if (duty_ != Duty{}) {
    duty_ = {};
    changes_.push_back({now, duty_});
  }
}

void Chip::start(ResetSource source) {
  ++starts_;
  power_ = ChipPower::kRunning;
  avr_reset(simavr_->avr);
  afterReset();
  simavr_->data(kMcusr) = static_cast<std::uint8_t>(source);
}

/// A reset restores simavr's defaults and removes all our timers.
void Chip::afterReset() {
  Simavr& s = *simavr_;
  s.reset_seen = false;
  s.avr->run_cycle_limit = settings_.profile ? 1 : settings_.run_limit;
  s.uart->flags = 0;  // no text on stdout, no sleep when the program polls
  // Otherwise simavr polls D2 and D3 in every cycle while they are low.
  avr_extint_set_strict_lvl_trig(s.avr, 0, 0);
  avr_extint_set_strict_lvl_trig(s.avr, 1, 0);
  s.writing_eeprom = false;
  settling_ = false;
  uart_.setBitCycles(0);
  interrupts_were_on_ = false;
  emitters_on_ = false;
  applyInputs();
  halt(power_);
  while (uart_.takeArrived(cycle())) {
    // Bytes that arrived while the chip was off are lost.
  }
  armReceiver();
}

void Chip::runTo(std::uint64_t target) {
  now_ = std::max(now_, target);
  if (power_ == ChipPower::kHeld && held_until_ < target) {
    idleTo(held_until_);
    start(ResetSource::kPin);
  }
  if (power_ == ChipPower::kRunning) {
    execute(target);
  } else {
    idleTo(target);
  }
}

void Chip::idleTo(std::uint64_t target) {
  if (target > cycle()) {
    offset_ += target - cycle();
  }
}

void Chip::execute(std::uint64_t target) {
  if (cycle() >= target) {
    return;
  }
  avr_t* avr = simavr_->avr;
  const std::uint64_t begin = avr->cycle;
  const std::uint64_t stop = target - offset_;
  const auto arm = [&] {
    if (stop > avr->cycle) {
      avr_cycle_timer_register(avr, stop - avr->cycle, Simavr::onStop, this);
    }
  };
  arm();
  while (avr->cycle < stop && power_ == ChipPower::kRunning) {
    ++counts_.rounds;
    const int state = avr_run(avr);
    if (simavr_->reset_seen) {
      ++counts_.resets;
      afterReset();
      arm();
    }
    if (settings_.profile) {
      measure();
    }
    if (state == cpu_Done || state == cpu_Crashed) {
      power_ = ChipPower::kCrashed;
    }
    if (power_cut_) {
      power_cut_ = false;
      switchOff();
    }
  }
  counts_.cycles_run += avr->cycle - begin;
  if (power_ != ChipPower::kRunning) {
    idleTo(target);
  }
}

void Chip::measure() {
  const std::uint64_t now = simavr_->avr->cycle;
  const bool on = simavr_->avr->sreg[S_I] != 0;
  if (on) {
    if (interrupts_were_on_ && interrupts_off_since_ != kNever) {
      counts_.longest_interrupts_off =
          std::max(counts_.longest_interrupts_off, now - interrupts_off_since_);
    }
    interrupts_were_on_ = true;
    interrupts_off_since_ = kNever;
  } else if (interrupts_off_since_ == kNever) {
    interrupts_off_since_ = now;
  }
  const auto stack =
      static_cast<std::uint16_t>(simavr_->data(kStackLow) | (simavr_->data(kStackHigh) << 8));
  // avr-gcc makes room for variables by writing the high byte first, so between the two writes the
  // pointer may be up to 255 bytes too low. Pushes and calls change the low byte too.
  const bool low_byte_same = ((stack ^ stack_) & 0xFF) == 0;
  stack_half_written_ = low_byte_same && (stack_half_written_ || stack != stack_);
  stack_ = stack;
  if (interrupts_were_on_ && !stack_half_written_) {
    counts_.lowest_stack = std::min(counts_.lowest_stack, stack);
  }
}

int Chip::stackHeadRoom() const { return counts_.lowest_stack - program_->ramEnd(); }

void Chip::setInputs(const AnalogInputs& inputs) {
  inputs_ = inputs;
  applyInputs();
}

void Chip::applyInputs() {
  const auto apply = [this](unsigned channel, std::uint16_t counts) {
    avr_raise_irq(avr_io_getirq(simavr_->avr, AVR_IOCTL_ADC_GETIRQ, static_cast<int>(channel)),
                  millivolts(counts));
  };
  for (unsigned i = 0; i < inputs_.ir.size(); ++i) {
    apply(ADC_IRQ_ADC0 + i, emitters_on_ ? inputs_.ir[i] : std::uint16_t{0});
  }
  apply(ADC_IRQ_ADC6, inputs_.light_front);
  apply(ADC_IRQ_ADC7, inputs_.light_back);
}

void Chip::recordDuty(std::uint64_t at) {
  const Duty duty = motorDuty(simavr_->avr->data);
  if (duty != duty_) {
    duty_ = duty;
    changes_.push_back({at, duty});
  }
}

std::vector<DutyChange> Chip::takeChanges(std::uint64_t until) {
  std::vector<DutyChange> taken;
  while (!changes_.empty() && changes_.front().cycle <= until) {
    taken.push_back(changes_.front());
    changes_.pop_front();
  }
  return taken;
}

void Chip::hang() {
  simavr_->avr->pc = program_->endlessLoop();
  simavr_->avr->state = cpu_Running;
  simavr_->avr->sreg[S_I] = 1;
}

// ---- serial line ----

void Chip::Simavr::onSent(avr_irq_t*, std::uint32_t value, void* object) {
  Chip& chip = chipOf(object);
  chip.uart_.send(static_cast<std::uint8_t>(value), chip.cycle());
  ++chip.counts_.bytes_sent;
}

avr_cycle_count_t Chip::Simavr::onArrival(avr_t* avr, avr_cycle_count_t, void* object) {
  Chip& chip = chipOf(object);
  const std::uint64_t now = chip.cycle();
  while (const std::optional<LineByte> byte = chip.uart_.takeArrived(now)) {
    chip.deliver(*byte);
  }
  const std::optional<std::uint64_t> next = chip.uart_.nextArrival();
  return next ? std::max(*next - chip.offset_, avr->cycle + 1) : 0;
}

void Chip::receive(LineByte byte) {
  uart_.receive(byte, now_);
  if (uart_.arriving() == 1 && power_ == ChipPower::kRunning) {
    armReceiver();
  }
}

void Chip::receive(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    receive(LineByte{byte, false});
  }
}

void Chip::armReceiver() {
  const std::optional<std::uint64_t> next = uart_.nextArrival();
  if (!next) {
    return;
  }
  avr_cycle_timer_register(simavr_->avr, *next > cycle() ? *next - cycle() : 1, Simavr::onArrival,
                           this);
}

/// Passes a byte whose stop bit has just ended to simavr, which would only begin to receive it now;
/// therefore its time per byte is set to one cycle meanwhile.
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

/// Computes the speed, because simavr adds a parity bit that does not exist, and only computes it
/// when the divider is written.
void Chip::updateBaud() {
  const Simavr& s = *simavr_;
  const std::uint64_t divider =
      1U + (s.data(kUbrr0Low) | (static_cast<std::uint64_t>(s.data(kUbrr0High) & 0x0FU) << 8U));
  uart_.setBitCycles(divider * ((s.data(kUcsr0A) & kU2x0) != 0 ? 8U : 16U));
  s.uart->cycles_per_byte = 10 * uart_.bitCycles();
}

double Chip::baud() const {
  const std::uint64_t bit_cycles = uart_.bitCycles();
  return bit_cycles == 0 ? 0 : kChipHz / static_cast<double>(bit_cycles);
}

// ---- EEPROM ----

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

/// Called at every access to EECR. simavr writes the EEPROM in no time; on the chip, bit EEPE is
/// set for 3.4 ms.
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
