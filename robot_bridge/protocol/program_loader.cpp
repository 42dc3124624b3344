#include "robot_bridge/protocol/program_loader.hpp"

#include <algorithm>

namespace lab::bridge {
namespace {

constexpr int kAttempts = 3;

}  // namespace

void ProgramLoader::forget() {
  known_ = false;
  hashes_.clear();
  hash_ = 0;
}

void ProgramLoader::learn(const wire::Programs& programs) {
  known_ = true;
  hashes_.assign(std::begin(programs.hash), std::end(programs.hash));
}

bool ProgramLoader::has(std::uint32_t hash) const {
  return std::find(hashes_.begin(), hashes_.end(), hash) != hashes_.end();
}

wire::Frame ProgramLoader::next(std::uint32_t hash, const std::vector<std::uint8_t>& code,
                                std::int64_t now) {
  if (hash != hash_) {
    hash_ = hash;
    step_ = 0;
    attempts_ = 0;
    begun_utime_ = now;
  }
  wire::Frame frame;
  const std::size_t at = (step_ - 1) * wire::LoadData::kBytes;
  if (step_ == 0) {
    wire::pack(wire::LoadBegin{hash, static_cast<std::uint8_t>(code.size())}, 0, frame);
  } else if (at < code.size()) {
    wire::LoadData data;
    data.offset = static_cast<std::uint8_t>(at);
    const std::size_t size = std::min<std::size_t>(code.size() - at, wire::LoadData::kBytes);
    std::copy_n(code.begin() + static_cast<std::ptrdiff_t>(at), size, data.code);
    wire::pack(data, 0, frame);
  } else {
    wire::pack(wire::LoadEnd{hash}, 0, frame);
  }
  return frame;
}

ProgramLoader::Result ProgramLoader::finish(const wire::Frame& command, const wire::Ack& ack) {
  switch (ack.status) {
    case wire::kOk:
      ++step_;
      if (command.type != wire::LoadEnd::kType) return Result::kGoesOn;
      known_ = false;  // it may have taken the place of another program
      hashes_.push_back(hash_);
      hash_ = 0;
      return Result::kLoaded;
    case wire::kBusy:
      return Result::kBusy;
    case wire::kNoPlace:
      hash_ = 0;
      return Result::kNoPlace;
    default:
      step_ = 0;
      return ++attempts_ < kAttempts ? Result::kGoesOn : Result::kFailed;
  }
}

}  // namespace lab::bridge
