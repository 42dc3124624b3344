/// One ATmega328P at 8 MHz that runs a program unmodified.
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

/// What the pins A0 to A7 are connected to, in counts 0..1023.
struct AnalogInputs {
  std::array<std::uint16_t, 6> ir{};  ///< A0 to A5, seen only while the emitters (D10) are on
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
  kHeld,  ///< in reset or in a bootloader that leaves all pins alone
  kRunning,
  kCrashed,  ///< it sleeps with interrupts off, or ran into no program; its pins stay as they are
};

/// Why the chip starts, as its register MCUSR tells the program.
enum class ResetSource : std::uint8_t { kPowerOn = 1, kPin = 2, kBrownOut = 4 };

/// What was counted and measured since the chip was made.
struct ChipCounts {
  std::uint32_t resets = 0;  ///< of any kind but switching on
  std::uint64_t bytes_received = 0;
  std::uint64_t bytes_overrun = 0;  ///< lost because two were waiting in the receiver already
  std::uint64_t bytes_sent = 0;
  std::uint64_t eeprom_writes = 0;
  std::uint64_t cycles_run = 0;     ///< switched on
  std::uint64_t cycles_asleep = 0;  ///< of these
  std::uint64_t rounds = 0;         ///< of the simulator: what it costs
  /// Measured with ChipSettings::profile only.
  std::uint64_t longest_interrupts_off = 0;  ///< cycles, from the first time they were on
  std::uint16_t lowest_stack = 0xFFFF;       ///< smallest stack pointer
};

struct ChipSettings {
  double line_baud = 38400;  ///< of the other end, in bits per second of this chip's own time
  std::uint64_t seed = 1;    ///< of what RAM holds when the chip is switched on
  /// How many cycles the simulator may run between two looks at its timers. Changes nothing but the
  /// speed.
  std::uint64_t run_limit = 8000;
  bool profile = false;  ///< look after every instruction; a third slower
};

/// The electronics around it are the robot's (docs/robot.md): TB6612FNG on D2, D4, D5 (left wheel),
/// D8, D7, D6 (right wheel) and D9 (standby), IR emitters on D10, a serial line on D0 and D1.
///
/// Time is in cycles of the chip's own oscillator since the object was made, also while it is off.
/// What comes out depends on what went in and when, not on how the time was sliced.
///
/// Where libsimavr 1.6 differs from the chip, this class makes up for it: a byte takes ten bits;
/// the receiver holds two bytes and takes them at the sender's pace; an EEPROM write takes 3.4 ms.
/// What remains: PWM is taken from the registers, not from the pins; no noise; the brown-out
/// detector does not exist.
class Chip {
 public:
  explicit Chip(std::shared_ptr<const FirmwareImage> program, const ChipSettings& settings = {});
  ~Chip();
  Chip(const Chip&) = delete;
  Chip& operator=(const Chip&) = delete;

  /// Runs until the cycle; it may have gone up to a few cycles further.
  void runTo(std::uint64_t cycle);
  [[nodiscard]] std::uint64_t cycle() const;

  /// Switches on: RAM holds random bytes, the EEPROM what it held.
  void switchOn();
  void switchOff();
  /// Pulls the reset pin; the program starts after `held_cycles` (a bootloader's wait).
  void reset(std::uint64_t held_cycles = 0);
  [[nodiscard]] ChipPower power() const { return power_; }

  void setInputs(const AnalogInputs& inputs);

  /// Bytes that the other end sends from now on, or as soon as the line is free.
  void receive(LineByte byte);
  void receive(std::span<const std::uint8_t> bytes);
  /// Until when the line to the chip is busy [cycles].
  [[nodiscard]] std::uint64_t receivingUntil() const { return uart_.receivingUntil(); }
  /// Speed at which the other end sends, see ChipSettings.
  void setLineBaud(double line_baud) { uart_.setLineBitCycles(kChipHz / line_baud); }

  /// The bytes whose stop bits ended by `cycle`.
  [[nodiscard]] std::vector<SentByte> takeSent(std::uint64_t cycle) {
    return uart_.takeSent(cycle);
  }
  /// The bits per second of the chip's transmitter and receiver, 0: not set up.
  [[nodiscard]] double baud() const;

  /// What the motors were told up to `cycle`. Changes within 50 us of the first are one: a program
  /// sets pins and duties one after the other.
  [[nodiscard]] std::vector<DutyChange> takeChanges(std::uint64_t cycle);
  [[nodiscard]] Duty duty() const { return duty_; }

  /// Contents of the EEPROM, kEepromSize bytes. load() fills what is missing with 0xFF.
  [[nodiscard]] std::vector<std::uint8_t> eeprom() const;
  void loadEeprom(std::span<const std::uint8_t> bytes);
  /// Cuts the power in the middle of the n-th EEPROM write from now on (1: the next): that byte
  /// holds garbage, the chip is off. 0: never.
  void cutPowerInWrite(std::uint32_t n) { cut_in_write_ = n; }

  /// From now on the program counter stands in an endless loop, with interrupts on: what a program
  /// that hangs looks like to its watchdog.
  void hang();

  [[nodiscard]] const ChipCounts& counts() const { return counts_; }
  /// The smallest number of bytes between stack and variables, measured with profile.
  [[nodiscard]] int stackHeadRoom() const;

 private:
  struct Simavr;  // everything that needs simavr's headers

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
  void takeDuty(std::uint64_t cycle);

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

  bool interrupts_seen_on_ = false;
  std::uint64_t interrupts_off_since_ = 0;
  ChipCounts counts_;
};

}  // namespace lab::emulator
