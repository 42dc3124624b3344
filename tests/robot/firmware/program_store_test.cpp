#include "robot/firmware/program_store.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "tests/support/robot_on_bench.hpp"

namespace lab::firmware::program_store_test {
namespace {

using Code = std::vector<uint8_t>;

Code program(uint8_t size, uint8_t number) { return programOfSize(size, number); }

uint32_t hashOf(const Code& code) {
  return dynamics::programHash(code.data(), static_cast<uint8_t>(code.size()));
}

void collect(ProgramStore& store, const Code& code) {
  ASSERT_TRUE(store.begin(hashOf(code), static_cast<uint8_t>(code.size())));
  ASSERT_TRUE(store.take(0, code.data(), static_cast<uint8_t>(code.size())));
  ASSERT_TRUE(store.isComplete(hashOf(code)));
}

ProgramStore::Progress writeAll(ProgramStore& store, const Code& code, uint8_t place) {
  collect(store, code);
  store.write(place);
  ProgramStore::Progress progress = store.step();
  while (progress == ProgramStore::kWriting) progress = store.step();
  EXPECT_EQ(store.step(), ProgramStore::kIdle);
  return progress;
}

/// What a robot has in a place after a boot.
Code booted(BenchBoard& board, uint8_t place) {
  ProgramStore store(board);
  store.load();
  if (store.hash(place) == 0) return {};
  const dynamics::ProgramBytes found = store.find(store.hash(place));
  return {found.code, found.code + found.size};
}

TEST(ProgramStore, OfABlankChipIsEmpty) {
  BenchBoard board;
  ProgramStore store(board);
  store.load();
  for (uint8_t place = 0; place < ProgramStore::kPlaces; ++place) EXPECT_EQ(store.hash(place), 0U);
  EXPECT_EQ(store.find(1).size, 0);
  EXPECT_EQ(store.find(0).size, 0);
}

TEST(ProgramStore, KeepsFiveProgramsOfTheLargestSizeBehindTheSettings) {
  BenchBoard board;
  Settings settings;
  settings.uid = 77;
  encodeStore(settings, board.store.data());
  const auto before = board.store;
  ProgramStore store(board);
  store.load();
  for (uint8_t place = 0; place < ProgramStore::kPlaces; ++place) {
    EXPECT_EQ(writeAll(store, program(dynamics::kLargestProgram, place), place),
              ProgramStore::kWritten);
  }
  for (uint8_t place = 0; place < ProgramStore::kPlaces; ++place) {
    const Code code = program(dynamics::kLargestProgram, place);
    EXPECT_EQ(booted(board, place), code);
    EXPECT_EQ(store.placeOf(hashOf(code)), place);
  }
  EXPECT_TRUE(
      std::equal(before.begin(), before.begin() + ProgramStore::kAddress, board.store.begin()));
}

TEST(ProgramStore, ReadsAnImage) {
  BenchBoard board;
  const Code code = program(100, 9);
  encodeProgram(code.data(), 100, 4, board.store.data());
  EXPECT_EQ(booted(board, 4), code);
}

TEST(ProgramStore, WritesOnlyBytesThatDiffer) {
  BenchBoard board;
  ProgramStore store(board);
  store.load();
  writeAll(store, program(150, 1), 2);
  const int before = board.store_writes;
  writeAll(store, program(150, 2), 2);
  // The magic twice, four bytes of the hash, the number.
  EXPECT_LE(board.store_writes - before, 7);
}

TEST(ProgramStore, EverySingleBitErrorIsDetectedAtBoot) {
  const Code code = program(64, 3);
  for (std::size_t bit = 0; bit < (8 + 64) * 8; ++bit) {
    if (bit / 8 == 6 || bit / 8 == 7) continue;  // unused bytes
    BenchBoard board;
    encodeProgram(code.data(), 64, 1, board.store.data());
    board.store[ProgramStore::kAddress + ProgramStore::kPlaceSize + bit / 8] ^=
        static_cast<uint8_t>(1U << (bit % 8));
    ASSERT_EQ(booted(board, 1), Code{}) << bit;
  }
}

TEST(ProgramStore, ByteCodeThatIsInvalidIsNotUsedThoughItsHashFits) {
  BenchBoard board;
  Code code = program(64, 3);
  code[6] = 200;  // no instruction
  encodeProgram(code.data(), 64, 0, board.store.data());
  EXPECT_EQ(booted(board, 0), Code{});
}

TEST(ProgramStore, APowerCutAtAnyByteLeavesTheOldOrTheNewProgramOrNone) {
  const Code old = program(176, 1);
  Code fresh = program(120, 2);
  for (uint8_t& byte : fresh) {  // so that most bytes differ
    if (byte == dynamics::kNegate) byte = dynamics::kAbs;
  }
  const Code other = program(90, 3);
  BenchBoard begin;
  encodeProgram(old.data(), 176, 2, begin.store.data());
  encodeProgram(other.data(), 90, 3, begin.store.data());
  int cuts = 0;
  std::set<Code> found;
  for (int cut_at = 1;; ++cut_at) {
    bool cut = false;
    for (int garbage = 0; garbage < 256; ++garbage) {
      BenchBoard board = begin;
      ProgramStore store(board);
      store.load();
      collect(store, fresh);
      store.write(2);
      BenchBoard before = board;
      cut = false;
      while (store.step() == ProgramStore::kWriting) {
        if (board.store_writes == cut_at) {
          // The byte that was being written may have any value.
          for (std::size_t i = 0; i < board.store.size(); ++i) {
            if (board.store[i] != before.store[i]) {
              board.store[i] = static_cast<uint8_t>(garbage);
            }
          }
          cut = true;
          break;
        }
        before.store = board.store;
      }
      if (!cut) break;
      ++cuts;
      const Code left = booted(board, 2);
      ASSERT_TRUE(left.empty() || left == old || left == fresh) << cut_at << " " << garbage;
      ASSERT_EQ(booted(board, 3), other);
      found.insert(left);
      if (garbage % 64 == 0) {  // it can be loaded again
        ProgramStore next(board);
        next.load();
        ASSERT_EQ(writeAll(next, fresh, 2), ProgramStore::kWritten);
        ASSERT_EQ(booted(board, 2), fresh);
      }
    }
    if (!cut) break;
  }
  EXPECT_GT(cuts, 100 * 256);
  EXPECT_EQ(found, (std::set<Code>{{}, old, fresh})) << "each of the three occurs";
}

TEST(ProgramStore, ADefectiveEepromIsReported) {
  BenchBoard board;
  ProgramStore store(board);
  store.load();
  board.store_dead = true;
  EXPECT_EQ(writeAll(store, program(60, 1), 0), ProgramStore::kFailed);
  EXPECT_EQ(store.hash(0), 0U);
}

TEST(ProgramStore, TheRunningCopySurvivesTheLoadingOfAnotherProgram) {
  BenchBoard board;
  const Code running = program(176, 1);
  encodeProgram(running.data(), 176, 0, board.store.data());
  ProgramStore store(board);
  store.load();
  const dynamics::ProgramBytes copy = store.find(hashOf(running));
  EXPECT_EQ(writeAll(store, program(176, 2), 1), ProgramStore::kWritten);
  EXPECT_EQ(Code(copy.code, copy.code + copy.size), running);
}

TEST(ProgramStore, TakesBytesOnlyWithinTheProgram) {
  BenchBoard board;
  ProgramStore store(board);
  const uint8_t bytes[32] = {};
  EXPECT_FALSE(store.take(0, bytes, 32)) << "nothing was begun";
  EXPECT_FALSE(store.begin(1, 2));
  EXPECT_FALSE(store.begin(1, dynamics::kLargestProgram + 1));
  EXPECT_FALSE(store.begin(0, 100));
  ASSERT_TRUE(store.begin(1, 40));
  EXPECT_TRUE(store.take(32, bytes, 32));
  EXPECT_FALSE(store.take(40, bytes, 32));
  EXPECT_FALSE(store.take(255, bytes, 32));
}

}  // namespace
}  // namespace lab::firmware::program_store_test
