#pragma once

#include <stdint.h>

#include "robot/dynamics/motor.hpp"
#include "robot/firmware/board.hpp"

namespace lab {
namespace firmware {

/// The permanent settings of a robot.
struct Settings {
  uint32_t uid = 0;  ///< 0: none was ever stored
  dynamics::WheelCalibration left;
  dynamics::WheelCalibration right;
  int32_t wheel_base_um = 75000L;  ///< stored for the host, which converts orders
};

bool operator==(const Settings& a, const Settings& b);

/// Gains 0.5 to 1.5, dead bands up to 127, wheel base 1 to 50 cm.
bool isValid(const Settings& settings);

/// Layout of the EEPROM. Address 0 stays unused, because a brown-out during a write has been
/// observed to corrupt it.
constexpr uint16_t kBootCounterAddress = 2;  ///< 2 bytes, little endian
constexpr uint16_t kBankAddress[2] = {16, 64};
constexpr uint16_t kStoreSize = 1024;  ///< with the programs, see program_store.hpp

/// One bank: magic, layout version, length of the data, sequence number (2 bytes), data, CRC-16 of
/// all preceding bytes (2 bytes).
constexpr uint8_t kStoreMagic = 0xA7;
constexpr uint8_t kStoreLayout = 1;
constexpr uint8_t kStoreDataSize = 18;
constexpr uint8_t kBankSize = 1 + 1 + 1 + 2 + kStoreDataSize + 2;
constexpr uint8_t kNoBank = 255;

/// Writes the EEPROM image (kStoreSize bytes) of a robot with these settings that was never booted.
void encodeStore(const Settings& settings, uint8_t* image);

/// Stores the settings in two banks of the EEPROM. Writing uses the older bank; its magic is
/// cleared first and written last. So after a power failure at any time, the robot has either the
/// old or the new settings.
class SettingsStore {
 public:
  explicit SettingsStore(Board& board) : board_(board) {}

  /// Reads the newest valid bank. Without one the settings become the defaults.
  void load(Settings& settings);

  /// The bank that holds the settings, or kNoBank.
  uint8_t bank() const { return bank_; }

  /// Begins to write. Settings that are already stored are not written again.
  void begin(const Settings& settings);

  enum Progress : uint8_t { kIdle, kWriting, kWritten, kUnchanged, kFailed };

  /// Writes at most one byte and never waits. Returns each of kWritten, kUnchanged and kFailed
  /// once.
  Progress step();

 private:
  bool readBank(uint8_t bank, uint16_t& sequence, Settings& settings) const;
  bool put(uint8_t index, uint8_t byte);
  Progress finish();

  Board& board_;
  uint8_t bank_ = kNoBank;
  uint16_t sequence_ = 0;  ///< sequence number of bank_
  uint8_t target_ = 0;     ///< bank being written
  uint8_t next_ = 0;       ///< step of the write, see step()
  Progress progress_ = kIdle;
  uint8_t record_[kBankSize] = {};
};

}  // namespace firmware
}  // namespace lab
