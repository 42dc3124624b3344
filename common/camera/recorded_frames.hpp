/// The frame times of a recorded run, for its simulated twins (the key camera.frames).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

struct RecordedFrameTime {
  std::int64_t offset_us = 0;         ///< of the exposure, since the first step of the light
  std::vector<std::int32_t> missing;  ///< robots that the tracker did not see in it, rising
};

/// Parses lines "t_s,missing": a time in s, and ids separated by spaces. The first line is the
/// header. Times rise.
/// @param name of the text, for messages. @throws ExperimentError that names the line
[[nodiscard]] std::vector<RecordedFrameTime> parseRecordedFrames(std::string_view text,
                                                                 const std::string& name);

/// @throws ExperimentError
[[nodiscard]] std::vector<RecordedFrameTime> readRecordedFrames(const std::filesystem::path& file);

}  // namespace lab
