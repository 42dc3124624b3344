#include "sim_svc/camera/frame_times.hpp"

#include <cmath>

namespace lab::sim {

std::int64_t sampleUtime(std::int64_t start_utime, std::int64_t number, double rate) {
  return start_utime +
         static_cast<std::int64_t>(std::llround(static_cast<double>(number) * 1e6 / rate));
}

FrameTimes::FrameTimes(const Camera& camera, const std::filesystem::path& directory)
    : fps_(camera.fps), recorded_(!camera.frames.empty()) {
  if (recorded_) frames_ = readRecordedFrames(directory / camera.frames);
}

void FrameTimes::begin(std::int64_t start_utime) {
  start_utime_ = start_utime;
  latest_ = start_utime - 1;
  find();
}

void FrameTimes::beginScript(std::int64_t script_utime) {
  script_utime_ = script_utime;
  while (position_ < frames_.size() && script_utime + frames_[position_].offset_us <= latest_) {
    ++position_;
  }
  find();
}

const std::vector<std::int32_t>* FrameTimes::missing() const {
  if (!script_utime_ || position_ >= frames_.size()) return nullptr;
  return &frames_[position_].missing;
}

void FrameTimes::advance() {
  latest_ = next_.value_or(latest_);
  if (script_utime_) {
    ++position_;
  } else {
    ++number_;
  }
  find();
}

void FrameTimes::find() {
  if (!script_utime_) {
    next_ = sampleUtime(start_utime_, number_, fps_);
  } else if (position_ < frames_.size()) {
    next_ = *script_utime_ + frames_[position_].offset_us;
  } else {
    next_.reset();
  }
}

}  // namespace lab::sim
