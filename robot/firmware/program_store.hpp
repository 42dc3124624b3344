#pragma once

#include <stdint.h>

#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/program_source.hpp"
#include "robot/firmware/board.hpp"
#include "robot/wire/messages.hpp"

namespace lab {
namespace firmware {

/// The programs of motion in the EEPROM, and the loading of new ones.
///
/// A place has a magic byte, the size, the hash (4 bytes), 2 unused bytes and the byte code. The
/// magic is cleared first and written last, and a place counts only if its code has its hash and
/// passes checkByteCode(). So after a power failure at any time a place has the old program, the
/// new one, or none, and never a mixture.
///
/// A loaded program is collected in RAM and checked before a byte of the EEPROM changes. The
/// running program is executed from a second copy in RAM, so that its place may be read slowly.
class ProgramStore final : public dynamics::ProgramSource {
 public:
  static constexpr uint16_t kAddress = 96;
  static constexpr uint8_t kHeaderSize = 8;
  static constexpr uint8_t kPlaceSize = kHeaderSize + dynamics::kLargestProgram;
  static constexpr uint8_t kMagic = 0x9C;
  static constexpr uint8_t kPlaces = wire::kProgramPlaces;
  static constexpr uint8_t kNoPlace = 255;

  explicit ProgramStore(Board& board) : board_(board) {}

  /// Reads and checks all places; to be called at boot.
  void load();

  /// The hash of the program in a place; 0: none.
  uint32_t hash(uint8_t place) const { return hashes_[place]; }

  /// The place that was written last; new programs go behind it, so that the places wear evenly and
  /// the program that was loaded last is not the next to be overwritten.
  uint8_t lastWritten() const { return last_written_; }

  /// The place of a program, or kNoPlace.
  uint8_t placeOf(uint32_t hash) const;

  /// Copies the program into RAM. A program that is there already is not copied again.
  dynamics::ProgramBytes find(uint32_t hash) override;

  /// Begins to collect a program. Returns false if no program has this hash or size.
  bool begin(uint32_t hash, uint8_t size);

  /// Takes bytes of the program. Returns false if the offset is beyond it, or none was begun.
  bool take(uint8_t offset, const uint8_t* bytes, uint8_t count);

  /// Whether the collected program is the one with this hash; `fault` says what is wrong with it.
  bool isComplete(uint32_t hash) const;
  dynamics::ByteCodeFault fault() const;

  uint32_t collected() const { return collected_; }

  /// Begins to write the collected program into a place.
  void write(uint8_t place);

  enum Progress : uint8_t { kIdle, kWriting, kWritten, kFailed };

  /// Writes at most one byte and never waits. Returns each of kWritten and kFailed once.
  Progress step();

 private:
  bool readPlace(uint8_t place);
  uint8_t recordByte(uint8_t index) const;
  static uint16_t address(uint8_t place, uint8_t index);

  Board& board_;
  uint32_t hashes_[kPlaces] = {};
  uint32_t copied_ = 0;  ///< hash of the program in code_
  uint32_t collected_ = 0;
  uint8_t copied_size_ = 0;
  uint8_t collected_size_ = 0;
  uint8_t target_ = kNoPlace;  ///< being written
  uint8_t last_written_ = kPlaces - 1;
  uint8_t next_ = 0;  ///< step of the write, see step()
  uint8_t code_[dynamics::kLargestProgram] = {};
  uint8_t collection_[dynamics::kLargestProgram] = {};
};

/// Writes a program into a place of an EEPROM image (kStoreSize bytes).
void encodeProgram(const uint8_t* code, uint8_t size, uint8_t place, uint8_t* image);

}  // namespace firmware
}  // namespace lab
