// Commands that load programs or write the EEPROM.
#include "robot/firmware/device.hpp"

namespace lab {
namespace firmware {
namespace {

constexpr uint8_t kNoDetail = 0;

}  // namespace

Device::Answer Device::executeCommit(const wire::Frame& frame) {
  wire::Commit commit;
  if (!wire::unpack(frame, commit)) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  if (storing_ != 0 || duty_left_ != 0 || duty_right_ != 0) {
    return Answer{wire::kBusy, kNoDetail};
  }
  store_.begin(settings_);
  answerLater(frame);
  return Answer{kLater, kNoDetail};
}

bool Device::isUsed(uint32_t hash) const {
  for (uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
    if (core_.settings().programs[slot] == hash || staged_.programs[slot] == hash) {
      return true;
    }
  }
  return false;
}

/// A place for a new program: the next one whose program is in no slot. kNoPlace: there is none.
uint8_t Device::freePlace() const {
  uint8_t place = programs_.lastWritten();
  for (uint8_t i = 0; i < ProgramStore::kPlaces; ++i) {
    place = place + 1 < ProgramStore::kPlaces ? static_cast<uint8_t>(place + 1) : 0;
    if (programs_.hash(place) == 0 || !isUsed(programs_.hash(place))) {
      return place;
    }
  }
  return ProgramStore::kNoPlace;
}

Device::Answer Device::executeLoadBegin(const wire::Frame& frame) {
  wire::LoadBegin load;
  if (!wire::unpack(frame, load)) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  if (storing_ != 0) {
    return Answer{wire::kBusy, kNoDetail};
  }
  if (programs_.placeOf(load.hash) == ProgramStore::kNoPlace &&
      freePlace() == ProgramStore::kNoPlace) {
    return Answer{wire::kNoPlace, kNoDetail};
  }
  return programs_.begin(load.hash, load.size) ? Answer{wire::kOk, kNoDetail}
                                               : Answer{wire::kBadValue, 1};
}

// Takes the bytes from the frame itself: a second copy would be large for the stack.
Device::Answer Device::executeLoadData(const wire::Frame& frame) {
  if (frame.size != wire::payloadSize<wire::LoadData>()) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  if (storing_ != 0) {
    return Answer{wire::kBusy, kNoDetail};
  }
  return programs_.take(frame.payload[0], frame.payload + 1, wire::LoadData::kBytes)
             ? Answer{wire::kOk, kNoDetail}
             : Answer{wire::kBadValue, 0};
}

Device::Answer Device::executeLoadEnd(const wire::Frame& frame) {
  wire::LoadEnd end;
  if (!wire::unpack(frame, end)) {
    return Answer{wire::kBadLength, kNoDetail};
  }
  if (storing_ != 0) {
    return Answer{wire::kBusy, kNoDetail};
  }
  if (programs_.placeOf(end.hash) != ProgramStore::kNoPlace) {
    return Answer{wire::kOk, kNoDetail};
  }
  if (!programs_.isComplete(end.hash)) {
    return Answer{wire::kBadProgram, kNoDetail};
  }
  const dynamics::ByteCodeFault fault = programs_.fault();
  if (fault != dynamics::kValidByteCode) {
    return Answer{wire::kBadProgram, fault};
  }
  const uint8_t place = freePlace();
  if (place == ProgramStore::kNoPlace) {
    return Answer{wire::kNoPlace, kNoDetail};
  }
  programs_.write(place);
  answerLater(frame);
  return Answer{kLater, kNoDetail};
}

bool Device::takeSenses(const wire::Frame& frame, uint32_t now_ms) {
  wire::SetSenses senses;
  if (!wire::unpack(frame, senses)) {
    return false;
  }
  core_.advanceTo(now_ms);
  for (uint8_t i = 0; i < dynamics::kSenses; ++i) {
    core_.setSense(i, senses.sense[i]);
  }
  senses_id_ = senses.id;
  return true;
}

void Device::answerLater(const wire::Frame& frame) {
  storing_ = frame.type;
  storing_seq_ = frame.seq;
}

// Writes one byte per call; answers COMMIT or LOAD_END when everything is written and read back.
void Device::continueStoring(uint32_t now_ms) {
  bool failed = false;
  if (storing_ == wire::Commit::kType) {
    const SettingsStore::Progress progress = store_.step();
    if (progress == SettingsStore::kWriting) {
      return;
    }
    if (progress == SettingsStore::kWritten) {
      note(now_ms, wire::kSettingsStored, store_.bank());
    }
    failed = progress == SettingsStore::kFailed;
  } else if (storing_ == wire::LoadEnd::kType) {
    const ProgramStore::Progress progress = programs_.step();
    if (progress == ProgramStore::kWriting) {
      return;
    }
    if (progress == ProgramStore::kWritten) {
      note(now_ms, wire::kProgramStored, programs_.collected());
    }
    failed = progress == ProgramStore::kFailed;
  } else {
    return;
  }
  const Answer answer = {failed ? wire::kStoreFailed : wire::kOk, kNoDetail};
  if (executed_.type == storing_ && executed_.seq == storing_seq_) {
    executed_.answer = answer;
  }
  sendAck(storing_seq_, storing_, answer);
  storing_ = 0;
}

}  // namespace firmware
}  // namespace lab
