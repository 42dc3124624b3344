#include "robot/firmware/settings.hpp"

#include "robot/wire/crc16.hpp"
#include "robot/wire/fields.hpp"

namespace lab {
namespace firmware {
namespace {

/// The data of a bank in their order in the EEPROM.
struct StoredData {
  template <class S, class V>
  static void fields(S& s, V& v) {
    v(s.uid);
    v(s.left.gain_ppm);
    v(s.right.gain_ppm);
    v(s.left.dead_band);
    v(s.right.dead_band);
    v(s.wheel_base_um);
  }
};

constexpr uint8_t kDataAt = 5;
constexpr uint8_t kCrcAt = kDataAt + kStoreDataSize;

void encodeBank(const Settings& settings, uint16_t sequence, uint8_t* record) {
  wire::FieldWriter writer(record);
  writer(kStoreMagic);
  writer(kStoreLayout);
  writer(kStoreDataSize);
  writer(sequence);
  StoredData::fields(settings, writer);
  const uint16_t crc = wire::crc16(record, kCrcAt);
  writer(crc);
}

bool decodeBank(const uint8_t* record, uint16_t& sequence, Settings& settings) {
  wire::FieldReader reader(record);
  uint8_t magic = 0;
  uint8_t layout = 0;
  uint8_t length = 0;
  uint16_t crc = 0;
  reader(magic);
  reader(layout);
  reader(length);
  reader(sequence);
  StoredData::fields(settings, reader);
  reader(crc);
  return magic == kStoreMagic && layout == kStoreLayout && length == kStoreDataSize &&
         crc == wire::crc16(record, kCrcAt) && isValid(settings);
}

bool isValid(const dynamics::WheelCalibration& wheel) {
  return wheel.gain_ppm >= 500000L && wheel.gain_ppm <= 1500000L && wheel.dead_band <= 127;
}

}  // namespace

bool operator==(const Settings& a, const Settings& b) {
  return a.uid == b.uid && a.left == b.left && a.right == b.right &&
         a.wheel_base_um == b.wheel_base_um;
}

bool isValid(const Settings& settings) {
  return isValid(settings.left) && isValid(settings.right) && settings.wheel_base_um >= 10000L &&
         settings.wheel_base_um <= 500000L;
}

void encodeStore(const Settings& settings, uint8_t* image) {
  for (uint16_t i = 0; i < kStoreSize; ++i) {
    image[i] = 0xFF;
  }
  encodeBank(settings, 1, image + kBankAddress[0]);
}

void SettingsStore::load(Settings& settings) {
  settings = Settings();
  bank_ = kNoBank;
  for (uint8_t bank = 0; bank < 2; ++bank) {
    Settings read;
    uint16_t sequence = 0;
    // The numbers of the banks differ by 1, so that the newer one is known even after a
    // wrap-around.
    if (readBank(bank, sequence, read) &&
        (bank_ == kNoBank || static_cast<int16_t>(sequence - sequence_) > 0)) {
      settings = read;
      sequence_ = sequence;
      bank_ = bank;
    }
  }
}

void SettingsStore::begin(const Settings& settings) {
  Settings stored;
  uint16_t sequence = 0;
  if (bank_ != kNoBank && readBank(bank_, sequence, stored) && stored == settings) {
    progress_ = kUnchanged;
    return;
  }
  target_ = bank_ == 0 ? 1 : 0;
  encodeBank(settings, static_cast<uint16_t>(sequence_ + 1U), record_);
  next_ = 0;
  progress_ = kWriting;
}

// Step 0 clears the magic, steps 1 to kBankSize - 1 write the other bytes, step kBankSize writes
// the magic; then the bank is read back and checked.
SettingsStore::Progress SettingsStore::step() {
  const Progress progress = progress_;
  if (progress != kWriting) {
    progress_ = kIdle;
    return progress;
  }
  if (board_.storeBusy()) {
    return kWriting;
  }
  while (next_ <= kBankSize) {
    const uint8_t step = next_++;
    const bool magic = step == 0 || step == kBankSize;
    if (put(magic ? 0 : step, step == 0 ? 0 : record_[magic ? 0 : step])) {
      return kWriting;
    }
  }
  return finish();
}

// Writes a byte unless the EEPROM already holds it.
bool SettingsStore::put(uint8_t index, uint8_t byte) {
  const uint16_t address = static_cast<uint16_t>(kBankAddress[target_] + index);
  if (board_.readStore(address) == byte) {
    return false;
  }
  board_.writeStore(address, byte);
  return true;
}

SettingsStore::Progress SettingsStore::finish() {
  progress_ = kIdle;
  for (uint8_t i = 0; i < kBankSize; ++i) {
    if (board_.readStore(static_cast<uint16_t>(kBankAddress[target_] + i)) != record_[i]) {
      return kFailed;
    }
  }
  bank_ = target_;
  ++sequence_;
  return kWritten;
}

bool SettingsStore::readBank(uint8_t bank, uint16_t& sequence, Settings& settings) const {
  uint8_t record[kBankSize];
  for (uint8_t i = 0; i < kBankSize; ++i) {
    record[i] = board_.readStore(static_cast<uint16_t>(kBankAddress[bank] + i));
  }
  return decodeBank(record, sequence, settings);
}

}  // namespace firmware
}  // namespace lab
