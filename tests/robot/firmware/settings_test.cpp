#include "robot/firmware/settings.hpp"

#include <gtest/gtest.h>

#include "robot/wire/crc16.hpp"
#include "tests/support/robot_on_bench.hpp"

namespace lab::firmware {
namespace {

Settings settingsOf(uint32_t uid) {
  Settings settings;
  settings.uid = uid;
  settings.left.gain_ppm = 1012345;
  settings.left.dead_band = 11;
  settings.right.gain_ppm = 987654;
  settings.right.dead_band = 12;
  settings.wheel_base_um = 74321;
  return settings;
}

/// Writes until finished. @return the number of bytes written
int storeAll(BenchBoard& board, SettingsStore& store, const Settings& settings,
             SettingsStore::Progress expected = SettingsStore::kWritten) {
  const int before = board.store_writes;
  store.begin(settings);
  SettingsStore::Progress progress = store.step();
  while (progress == SettingsStore::kWriting) progress = store.step();
  EXPECT_EQ(progress, expected);
  EXPECT_EQ(store.step(), SettingsStore::kIdle);
  return board.store_writes - before;
}

Settings loaded(BenchBoard& board, uint8_t* bank = nullptr) {
  SettingsStore store(board);
  Settings settings;
  store.load(settings);
  if (bank != nullptr) *bank = store.bank();
  return settings;
}

TEST(Settings, OfABlankChipAreTheDefaults) {
  BenchBoard board;
  uint8_t bank = 0;
  EXPECT_EQ(loaded(board, &bank), Settings());
  EXPECT_EQ(bank, kNoBank);
}

TEST(Settings, AreReadFromAnImage) {
  BenchBoard board;
  encodeStore(settingsOf(0x51000007), board.store.data());
  uint8_t bank = 9;
  EXPECT_EQ(loaded(board, &bank), settingsOf(0x51000007));
  EXPECT_EQ(bank, 0);
  EXPECT_EQ(board.store[0], 0xFF) << "address 0 is not used";
}

TEST(Settings, AlternateBetweenTheBanks) {
  BenchBoard board;
  SettingsStore store(board);
  Settings settings;
  store.load(settings);
  for (uint32_t i = 0; i < 5; ++i) {
    storeAll(board, store, settingsOf(i + 1));
    uint8_t bank = 9;
    EXPECT_EQ(loaded(board, &bank), settingsOf(i + 1));
    EXPECT_EQ(bank, i % 2);
    EXPECT_EQ(store.bank(), bank);
  }
}

TEST(Settings, AreNotWrittenIfUnchanged) {
  BenchBoard board;
  SettingsStore store(board);
  storeAll(board, store, settingsOf(1));
  EXPECT_EQ(storeAll(board, store, settingsOf(1), SettingsStore::kUnchanged), 0);
}

TEST(Settings, WriteOnlyBytesThatDiffer) {
  BenchBoard board;
  SettingsStore store(board);
  storeAll(board, store, settingsOf(1));
  storeAll(board, store, settingsOf(2));
  // The third write goes to bank 0 again. It writes the magic twice, the sequence number, one byte
  // of the uid and two bytes of the CRC.
  EXPECT_LE(storeAll(board, store, settingsOf(3)), 6);
}

TEST(Settings, NewestBankIsFoundAcrossTheWrapOfTheSequence) {
  BenchBoard board;
  SettingsStore store(board);
  for (uint32_t i = 0; i < 65540; ++i) storeAll(board, store, settingsOf(i + 1));
  EXPECT_EQ(loaded(board), settingsOf(65540));
}

TEST(Settings, WithAnotherLayoutOrOutOfRangeAreNotUsed) {
  const auto loadedWithChangedByte = [](std::size_t offset, uint8_t byte) {
    BenchBoard board;
    encodeStore(settingsOf(1), board.store.data());
    uint8_t* bank = board.store.data() + kBankAddress[0];
    bank[offset] = byte;
    const uint16_t crc = wire::crc16(bank, kBankSize - 2);
    bank[kBankSize - 2] = static_cast<uint8_t>(crc & 0xFF);
    bank[kBankSize - 1] = static_cast<uint8_t>(crc >> 8);
    return loaded(board);
  };
  EXPECT_EQ(loadedWithChangedByte(5, 1), settingsOf(1))
      << "unchanged bytes with a correct CRC are valid";
  EXPECT_EQ(loadedWithChangedByte(1, kStoreLayout + 1), Settings());
  EXPECT_EQ(loadedWithChangedByte(2, kStoreDataSize + 1), Settings());
  EXPECT_EQ(loadedWithChangedByte(5 + 4 + 3, 0x7F), Settings()) << "a gain far beyond 1.5";
}

TEST(Settings, EverySingleBitErrorIsDetected) {
  for (std::size_t bit = 0; bit < kBankSize * 8; ++bit) {
    BenchBoard board;
    encodeStore(settingsOf(1), board.store.data());
    board.store[kBankAddress[0] + bit / 8] ^= static_cast<uint8_t>(1U << (bit % 8));
    ASSERT_EQ(loaded(board), Settings()) << bit;
  }
}

/// Cuts the power while a byte is written. This byte may then have any value.
class FailingBoard {
 public:
  FailingBoard(const BenchBoard& board, const Settings& settings, int cut_at, uint8_t garbage)
      : board_(board) {
    SettingsStore store(board_);
    Settings old;
    store.load(old);
    store.begin(settings);
    const BenchBoard before_all = board_;
    BenchBoard before = before_all;
    while (store.step() == SettingsStore::kWriting) {
      if (board_.store_writes - before_all.store_writes == cut_at) {
        spoil(before, garbage);
        cut_ = true;
        return;
      }
      before = board_;
    }
  }
  bool cut() const { return cut_; }
  BenchBoard& board() { return board_; }

 private:
  void spoil(const BenchBoard& before, uint8_t garbage) {
    for (std::size_t i = 0; i < board_.store.size(); ++i) {
      if (board_.store[i] != before.store[i]) board_.store[i] = garbage;
    }
  }
  BenchBoard board_;
  bool cut_ = false;
};

TEST(Settings, APowerCutAtAnyByteLeavesTheOldOrTheNewSettings) {
  int cuts = 0;
  for (int history = 0; history < 4; ++history) {
    BenchBoard board;
    SettingsStore store(board);
    for (int i = 0; i < history; ++i) {
      storeAll(board, store, settingsOf(static_cast<uint32_t>(i) + 1));
    }
    const Settings old = loaded(board);
    const Settings fresh = settingsOf(0xFEDCBA98);
    for (int cut_at = 1;; ++cut_at) {
      bool cut = false;
      for (int garbage = 0; garbage < 256; ++garbage) {
        FailingBoard failing(board, fresh, cut_at, static_cast<uint8_t>(garbage));
        cut = failing.cut();
        if (!cut) break;
        ++cuts;
        const Settings found = loaded(failing.board());
        ASSERT_TRUE(found == old || found == fresh) << history << " " << cut_at << " " << garbage;
        // The next write must succeed.
        SettingsStore next(failing.board());
        Settings ignored;
        next.load(ignored);
        storeAll(failing.board(), next, settingsOf(77));
        ASSERT_EQ(loaded(failing.board()), settingsOf(77));
      }
      if (!cut) break;
    }
    EXPECT_EQ(loaded(board), old);
  }
  EXPECT_GT(cuts, 4 * 256 * 5);
}

TEST(Settings, ADefectiveEepromIsReported) {
  BenchBoard board;
  SettingsStore store(board);
  storeAll(board, store, settingsOf(1));
  board.store_dead = true;
  storeAll(board, store, settingsOf(2), SettingsStore::kFailed);
  EXPECT_EQ(store.bank(), 0);
  EXPECT_EQ(loaded(board), settingsOf(1));
}

}  // namespace
}  // namespace lab::firmware
