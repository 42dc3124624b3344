/// When the simulated camera exposes its frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/camera/recorded_frames.hpp"
#include "common/experiment/experiment.hpp"

namespace lab::sim {

/// Time of sample `number` at this rate; rounding errors do not accumulate.
[[nodiscard]] std::int64_t sampleUtime(std::int64_t start_utime, std::int64_t number, double rate);

/// Exposures at multiples of the period; or, with camera.frames, from the start of the script on at
/// the times of a recorded run.
class FrameTimes {
 public:
  /// @param directory folder to which the path of camera.frames is relative
  /// @throws ExperimentError
  FrameTimes(const Camera& camera, const std::filesystem::path& directory);

  /// @param start_utime exposure of the first frame
  void begin(std::int64_t start_utime);

  [[nodiscard]] bool isRecorded() const { return recorded_; }
  [[nodiscard]] bool inScript() const { return script_utime_.has_value(); }

  /// Goes over to the recorded frames. Those up to the latest exposure are left out.
  void beginScript(std::int64_t script_utime);

  /// The next exposure; nothing after the last recorded frame.
  [[nodiscard]] std::optional<std::int64_t> next() const { return next_; }

  /// Robots that the next frame does not have; null: it is not a recorded one. Valid while this
  /// object lives.
  [[nodiscard]] const std::vector<std::int32_t>* missing() const;

  void advance();

 private:
  void find();

  double fps_;
  bool recorded_ = false;
  std::vector<RecordedFrameTime> frames_;
  std::int64_t start_utime_ = 0;
  std::optional<std::int64_t> script_utime_;
  std::int64_t number_ = 0;   ///< of the next frame, before the script
  std::size_t position_ = 0;  ///< of the next recorded frame
  std::int64_t latest_ = 0;   ///< exposure before the next one
  std::optional<std::int64_t> next_;
};

}  // namespace lab::sim
