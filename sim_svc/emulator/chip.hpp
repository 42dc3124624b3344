/// A simulated ATmega328P at 8 MHz that runs an unmodified program.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "sim_svc/emulator/chip_uart.hpp"
#include "sim_svc/emulator/firmware_image.hpp"
#include "sim_svc/emulator/line_faults.hpp"

namespace lab::emulator {

inline constexpr double kChipHz = 8e6;
inline constexpr std::uint64_t kNever = ~0ULL;

/// The inputs at the pins A0 to A7, in counts 0..1023.
struct AnalogInputs {
  std::array<std::uint16_t, 6> ir{};  ///< A0 to A5, applied only while the emitters (D10) are on
  std::uint16_t light_front = 0;      ///< A6
  std::uint16_t light_back = 0;       ///< A7
};

/// Both motors, signed duty -255..255.
struct Duty {
  std::int16_t left = 0;
  std::int16_t right = 0;
  bool operator==(const Duty&) const = default;
};

struct DutyChange {
  std::uint64_t cycle = 0;
  Duty duty;
};

enum class ChipPower : std::uint8_t {
  kOff,
  kHeld,  ///< in reset, or in a bootloader that does not drive any pins
  kRunning,
  kCrashed,  ///< it sleeps with interrupts off, or left the program memory; pins keep their state
};

/// Why the chip starts, as in its register MCUSR.
enum class ResetSource : std::uint8_t { kPowerOn = 1, kPin = 2, kBrownOut = 4 };

/// Counts and measurements since the object was created.
struct ChipCounts {
  std::uint32_t resets = 0;  ///< of any kind except power-on
  std::uint64_t bytes_received = 0;
  std::uint64_t bytes_overrun = 0;  ///< lost because the receiver already held two bytes
  std::uint64_t bytes_sent = 0;
  std::uint64_t eeprom_writes = 0;
  std::uint64_t cycles_run = 0;     ///< with the chip switched on
  std::uint64_t cycles_asleep = 0;  ///< part of cycles_run
  std::uint64_t rounds = 0;         ///< iterations of the simulator, a measure of its cost
  /// Only measured with ChipSettings::profile.
  std::uint64_t longest_interrupts_off = 0;  ///< cycles, after the first time they were on
  std::uint16_t lowest_stack = 0xFFFF;       ///< smallest stack pointer
};

struct ChipSettings {
  double line_baud = 38400;  ///< of the other end, in bits per second of this chip's time
  std::uint64_t seed = 1;    ///< of the contents of RAM at power-on
  /// Largest number of cycles that the simulator runs before it checks its timers. Only affects the
  /// speed.
  std::uint64_t run_limit = 8000;
  bool profile = false;  ///< measure after every instruction; a third slower
};

/// The chip in the robot's electronics (docs/robot.md): TB6612FNG on D2, D4, D5 (left wheel), D8,
/// D7, D6 (right wheel) and D9 (standby), IR emitters on D10, a serial line on D0 and D1.
///
/// Time is in cycles of the chip's oscillator since the object was created, also while the chip is
/// off. The outputs depend on the inputs and their times, not on the lengths of the runTo() steps.
///
/// This class corrects differences between libsimavr 1.6 and the chip: a byte takes ten bits; the
/// receiver holds two bytes and receives at the sender's speed; an EEPROM write takes 3.4 ms.
/// Remaining differences: PWM is read from the registers, not from the pins; there is no analog
/// noise; there is no brown-out detector.
class Chip {
 public:
  explicit Chip(std::shared_ptr<const FirmwareImage> program, const ChipSettings& settings = {});
  ~Chip();
  Chip(const Chip&) = delete;
  Chip& operator=(const Chip&) = delete;

  /// Runs until the cycle, or a few cycles further, because instructions are not interrupted.
  void runTo(std::uint64_t cycle);
  [[nodiscard]] std::uint64_t cycle() const;

  /// Switches on, with random bytes in RAM and the EEPROM unchanged.
  void switchOn();
  void switchOff();
  /// Pulls the reset pin; the program starts after `held_cycles` (a bootloader's wait).
  void reset(std::uint64_t held_cycles = 0);
  [[nodiscard]] ChipPower power() const { return power_; }

  void setInputs(const AnalogInputs& inputs);

  /// The other end sends bytes now, or as soon as the line is free.
  void receive(LineByte byte);
  void receive(std::span<const std::uint8_t> bytes);
  /// When the line to the chip is free [cycles].
  [[nodiscard]] std::uint64_t receivingUntil() const { return uart_.receivingUntil(); }
  /// Sets the speed at which the other end sends, see ChipSettings.
  void setLineBaud(double line_baud) { uart_.setLineBitCycles(kChipHz / line_baud); }

  /// The bytes whose stop bits ended by `cycle`.
  [[nodiscard]] std::vector<SentByte> takeSent(std::uint64_t cycle) {
    return uart_.takeSent(cycle);
  }
  /// Speed of the chip's transmitter and receiver in bits per second; 0: not set up.
  [[nodiscard]] double baud() const;

  /// The changes of the motor duties up to `cycle`. Changes within 50 us are combined, because a
  /// program sets pins and duties one after the other.
  [[nodiscard]] std::vector<DutyChange> takeChanges(std::uint64_t cycle);
  [[nodiscard]] Duty duty() const { return duty_; }

  /// Contents of the EEPROM, kEepromSize bytes. loadEeprom() fills missing bytes with 0xFF.
  [[nodiscard]] std::vector<std::uint8_t> eeprom() const;
  void loadEeprom(std::span<const std::uint8_t> bytes);
  /// Cuts the power during the n-th EEPROM write from now (1: the next). Then that byte has a
  /// random value and the chip is off. 0: never.
  void cutPowerInWrite(std::uint32_t n) { cut_in_write_ = n; }

  /// Puts the program counter into an endless loop, with interrupts on, to test the watchdog.
  void hang();

  [[nodiscard]] const ChipCounts& counts() const { return counts_; }
  /// Smallest number of bytes between stack and variables; needs profile.
  [[nodiscard]] int stackHeadRoom() const;

 private:
  struct Simavr;  // isolates simavr's headers

  void start(ResetSource source);
  void afterReset();
  void halt(ChipPower power);
  void idleTo(std::uint64_t cycle);
  void execute(std::uint64_t cycle);
  void measure();
  void applyInputs();
  void updateBaud();
  void watchEeprom(std::uint32_t value);
  void armReceiver();
  void deliver(LineByte byte);
  void recordDuty(std::uint64_t cycle);

  std::shared_ptr<const FirmwareImage> program_;
  ChipSettings settings_;
  std::unique_ptr<Simavr> simavr_;
  ChipPower power_ = ChipPower::kOff;
  std::uint64_t offset_ = 0;      // cycle() minus simavr's count
  std::uint64_t held_until_ = 0;  // kHeld
  std::uint64_t now_ = 0;         // what the last runTo() was asked for
  std::uint32_t starts_ = 0;

  AnalogInputs inputs_;
  bool emitters_on_ = false;

  ChipUart uart_;

  Duty duty_;
  bool settling_ = false;
  std::deque<DutyChange> changes_;

  std::uint32_t cut_in_write_ = 0;
  bool power_cut_ = false;

  bool interrupts_were_on_ = false;
  std::uint64_t interrupts_off_since_ = 0;
  std::uint16_t stack_ = 0;  // the stack pointer after the previous instruction
  bool stack_half_written_ = false;
  ChipCounts counts_;
};

}  // namespace lab::emulator
