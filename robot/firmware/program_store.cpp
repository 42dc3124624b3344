#include "robot/firmware/program_store.hpp"

namespace lab {
namespace firmware {
namespace {

constexpr uint8_t kMagicAt = 0;
constexpr uint8_t kSizeAt = 1;
constexpr uint8_t kHashAt = 2;
constexpr uint8_t kShortestProgram = 3;

uint8_t byteOf(uint32_t value, uint8_t index) {
  return static_cast<uint8_t>(value >> (8U * index));
}

}  // namespace

constexpr uint16_t ProgramStore::kAddress;
constexpr uint8_t ProgramStore::kHeaderSize;
constexpr uint8_t ProgramStore::kMagic;

uint16_t ProgramStore::address(uint8_t place, uint8_t index) {
  return static_cast<uint16_t>(kAddress + static_cast<uint16_t>(place) * kPlaceSize + index);
}

void ProgramStore::load() {
  copied_ = 0;
  for (uint8_t place = 0; place < kPlaces; ++place) {
    hashes_[place] = 0;
    uint32_t hash = 0;
    for (uint8_t i = 4; i > 0; --i) {
      hash = hash << 8 | board_.readStore(address(place, static_cast<uint8_t>(kHashAt + i - 1)));
    }
    if (board_.readStore(address(place, kMagicAt)) == kMagic && readPlace(place) &&
        dynamics::programHash(code_, copied_size_) == hash &&
        dynamics::checkByteCode(code_, copied_size_).fault == dynamics::kValidByteCode) {
      hashes_[place] = hash;
    }
  }
}

// Copies the code of a place into RAM. Returns false if no program has its size.
bool ProgramStore::readPlace(uint8_t place) {
  const uint8_t size = board_.readStore(address(place, kSizeAt));
  if (size < kShortestProgram || size > dynamics::kLargestProgram) {
    return false;
  }
  copied_size_ = size;
  for (uint8_t i = 0; i < size; ++i) {
    code_[i] = board_.readStore(address(place, static_cast<uint8_t>(kHeaderSize + i)));
  }
  return true;
}

uint8_t ProgramStore::placeOf(uint32_t hash) const {
  for (uint8_t place = 0; place < kPlaces; ++place) {
    if (hash != 0 && hashes_[place] == hash) {
      return place;
    }
  }
  return kNoPlace;
}

dynamics::ProgramBytes ProgramStore::find(uint32_t hash) {
  dynamics::ProgramBytes program;
  if (hash != copied_ || hash == 0) {
    const uint8_t place = placeOf(hash);
    copied_ = 0;
    if (place == kNoPlace || !readPlace(place)) {
      return program;
    }
    copied_ = hash;
  }
  program.code = code_;
  program.size = copied_size_;
  return program;
}

bool ProgramStore::begin(uint32_t hash, uint8_t size) {
  if (hash == 0 || size < kShortestProgram || size > dynamics::kLargestProgram) {
    return false;
  }
  collected_ = hash;
  collected_size_ = size;
  return true;
}

bool ProgramStore::take(uint8_t offset, const uint8_t* bytes, uint8_t count) {
  if (offset >= collected_size_) {
    return false;
  }
  for (uint8_t i = 0; i < count && i < collected_size_ - offset; ++i) {
    collection_[offset + i] = bytes[i];
  }
  return true;
}

bool ProgramStore::isComplete(uint32_t hash) const {
  return hash == collected_ && dynamics::programHash(collection_, collected_size_) == hash;
}

dynamics::ByteCodeFault ProgramStore::fault() const {
  return dynamics::checkByteCode(collection_, collected_size_).fault;
}

void ProgramStore::write(uint8_t place) {
  hashes_[place] = 0;
  last_written_ = place;
  target_ = place;
  next_ = 0;
}

uint8_t ProgramStore::recordByte(uint8_t index) const {
  if (index >= kHeaderSize) {
    return collection_[index - kHeaderSize];
  }
  if (index >= kHashAt && index < kHashAt + 4) {
    return byteOf(collected_, static_cast<uint8_t>(index - kHashAt));
  }
  return index == kMagicAt ? kMagic : index == kSizeAt ? collected_size_ : 0;
}

// Step 0 clears the magic, the next ones write the other bytes unless the EEPROM already holds
// them, the last one writes the magic; then the place is read back.
ProgramStore::Progress ProgramStore::step() {
  if (target_ == kNoPlace) {
    return kIdle;
  }
  if (board_.storeBusy()) {
    return kWriting;
  }
  const uint8_t size = static_cast<uint8_t>(kHeaderSize + collected_size_);
  while (next_ <= size) {
    const uint8_t step = next_++;
    const uint8_t index = step == size ? kMagicAt : step;
    const uint8_t byte = step == kMagicAt ? 0 : recordByte(index);
    if (board_.readStore(address(target_, index)) != byte) {
      board_.writeStore(address(target_, index), byte);
      return kWriting;
    }
  }
  const uint8_t place = target_;
  target_ = kNoPlace;
  for (uint8_t i = 0; i < size; ++i) {
    if (board_.readStore(address(place, i)) != recordByte(i)) {
      return kFailed;
    }
  }
  hashes_[place] = collected_;
  return kWritten;
}

void encodeProgram(const uint8_t* code, uint8_t size, uint8_t place, uint8_t* image) {
  uint8_t* at = image + ProgramStore::kAddress + place * ProgramStore::kPlaceSize;
  const uint32_t hash = dynamics::programHash(code, size);
  at[kMagicAt] = ProgramStore::kMagic;
  at[kSizeAt] = size;
  for (uint8_t i = 0; i < 4; ++i) {
    at[kHashAt + i] = byteOf(hash, i);
  }
  for (uint8_t i = 0; i < size; ++i) {
    at[ProgramStore::kHeaderSize + i] = code[i];
  }
}

}  // namespace firmware
}  // namespace lab
