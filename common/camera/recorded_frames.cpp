#include "common/camera/recorded_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>

#include "common/files/experiment_error.hpp"
#include "common/files/file_text.hpp"

namespace lab {
namespace {

constexpr std::string_view kHeader = "t_s,missing";
constexpr double kLatest = 1e7;  // [s]

[[noreturn]] void refuseLine(const std::string& name, std::size_t line, std::string_view found) {
  throw ExperimentError({fmt::format(
      "{}:{}: found {}, allowed a time in s that is later than the one before, a comma, and ids of "
      "robots with spaces between them",
      name, line, found.empty() ? "nothing" : found.substr(0, 40))});
}

}  // namespace

std::vector<RecordedFrameTime> parseRecordedFrames(std::string_view text, const std::string& name) {
  std::vector<RecordedFrameTime> frames;
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (++number == 1) {
      if (line != kHeader) {
        throw ExperimentError({fmt::format("{}:1: found {}, allowed the header {}", name,
                                           line.substr(0, 40), kHeader)});
      }
      continue;
    }
    RecordedFrameTime frame;
    double seconds = 0;
    const char* const last = line.data() + line.size();
    auto read = std::from_chars(line.data(), last, seconds);
    const bool time = read.ec == std::errc() && read.ptr != last && *read.ptr == ',' &&
                      seconds >= 0 && seconds <= kLatest;
    if (!time) refuseLine(name, number, line);
    frame.offset_us = std::llround(seconds * 1e6);
    if (!frames.empty() && frame.offset_us <= frames.back().offset_us) {
      refuseLine(name, number, line);
    }
    for (const char* at = read.ptr + 1; at != last;) {
      std::int32_t id = 0;
      read = std::from_chars(at, last, id);
      if (read.ec != std::errc() || (read.ptr != last && *read.ptr != ' ')) {
        refuseLine(name, number, line);
      }
      frame.missing.push_back(id);
      at = read.ptr == last ? last : read.ptr + 1;
    }
    std::ranges::sort(frame.missing);
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::vector<RecordedFrameTime> readRecordedFrames(const std::filesystem::path& file) {
  return parseRecordedFrames(readFileText(file, file_kinds::kFrameTable), file.string());
}

}  // namespace lab
