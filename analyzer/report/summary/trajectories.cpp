#include "analyzer/report/summary/trajectories.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <tuple>
#include <vector>

#include "common/math/units.hpp"

namespace lab::report {
namespace {

/// Appends units * 10^-decimals with a fixed number of decimals. Faster than formatting a double.
void appendFixed(fmt::memory_buffer& out, std::int64_t units, int decimals) {
  std::int64_t scale = 1;
  for (int i = 0; i < decimals; ++i) scale *= 10;
  if (units < 0) {
    out.push_back('-');
    units = -units;
  }
  const fmt::format_int whole(units / scale);
  out.append(whole.data(), whole.data() + whole.size());
  out.push_back('.');
  const fmt::format_int digits(units % scale + scale);  // the leading 1 keeps leading zeros
  out.append(digits.data() + 1, digits.data() + digits.size());
}

/// Appends value * scale * 10^-decimals; nan if it is not finite or too large.
void appendNumber(fmt::memory_buffer& out, double value, double scale, int decimals) {
  constexpr double kLargest = 1e15;
  const double units = value * scale;
  if (!(std::abs(units) < kLargest)) {
    out.append(std::string_view("nan"));
    return;
  }
  appendFixed(out, std::llround(units), decimals);
}

std::string_view stateText(analysis::FrameState state) {
  switch (state) {
    case analysis::FrameState::kFree:
      return "free";
    case analysis::FrameState::kReversing:
      return "reversing";
    case analysis::FrameState::kContact:
      return "contact";
    case analysis::FrameState::kStopped:
      return "stopped";
    case analysis::FrameState::kLost:
      return "lost";
    case analysis::FrameState::kOther:
      return "other";
  }
  return "";
}

std::string_view contactText(const TrackRow& row) {
  if (row.contact_robot) return row.contact_wall ? "both" : "robot";
  return row.contact_wall ? "wall" : "none";
}

}  // namespace

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char letter : text)
    field += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  return field + "\"";
}

std::string trajectoriesCsv(const RunRecord& record) {
  constexpr std::size_t kRow_bytes = 104;
  constexpr double kPerMetre = 1e6;   // cm with 4 decimals
  constexpr double kPerRadian = 1e6;  // rad with 6 decimals
  constexpr double kPerLight = 1e4;   // readings with 4 decimals
  fmt::memory_buffer out;
  out.reserve(record.tracks.rows.size() * kRow_bytes + 64);
  out.append(
      std::string_view("frame,particle,x,y,t,theta,program,segment,state,contact,light_front,"
                       "light_back,x_stitched,y_stitched\n"));

  std::vector<std::string> names{"standing"};
  for (const RunProgram& program : record.programs) names.push_back(csvField(program.name));
  for (std::size_t i = 0; i < record.tracks.frames.size(); ++i) {
    const TrackFrame& frame = record.tracks.frames[i];
    const std::int64_t since_start = frame.utime - record.start_utime;
    for (std::size_t r = frame.first_row; r < record.tracks.endOf(i); ++r) {
      const TrackRow& row = record.tracks.rows[r];
      fmt::format_to(std::back_inserter(out), FMT_COMPILE("{},{},"), frame.frame, row.robot);
      appendNumber(out, static_cast<double>(row.x), kPerMetre, 4);
      out.push_back(',');
      appendNumber(out, static_cast<double>(row.y), kPerMetre, 4);
      out.push_back(',');
      appendFixed(out, since_start, 6);
      out.push_back(',');
      appendNumber(out, static_cast<double>(row.theta), kPerRadian, 6);
      out.push_back(',');
      out.append(names[static_cast<std::size_t>(row.program + 1)]);
      fmt::format_to(std::back_inserter(out), FMT_COMPILE(",{},"), row.segment);
      out.append(stateText(row.state));
      out.push_back(',');
      out.append(contactText(row));
      for (const auto& [value, scale, decimals] :
           {std::tuple(row.light_front, kPerLight, 4), std::tuple(row.light_back, kPerLight, 4),
            std::tuple(row.stitched_x, kPerMetre, 4), std::tuple(row.stitched_y, kPerMetre, 4)}) {
        out.push_back(',');
        appendNumber(out, static_cast<double>(value), scale, decimals);
      }
      out.push_back('\n');
    }
  }
  return fmt::to_string(out);
}

}  // namespace lab::report
