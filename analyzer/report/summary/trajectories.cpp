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
#include "common/text/format.hpp"

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

std::string csvField(const std::string& content) {
  const std::string text = (isSpreadsheetFormula(content) ? "'" : "") + content;
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char letter : text)
    field += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  return field + "\"";
}

void writeTrajectories(const RunRecord& record, std::ostream& out) {
  constexpr std::size_t kPart_bytes = 1U << 20U;
  constexpr double kPerMetre = 1e6;   // cm with 4 decimals
  constexpr double kPerRadian = 1e6;  // rad with 6 decimals
  constexpr double kPerLight = 1e4;   // readings with 4 decimals
  fmt::memory_buffer part;
  const auto write = [&] {
    out.write(part.data(), static_cast<std::streamsize>(part.size()));
    part.clear();
  };
  part.append(
      std::string_view("frame,particle,x,y,t,theta,program,segment,state,contact,light_front,"
                       "light_back,x_stitched,y_stitched\n"));

  std::vector<std::string> names{"standing"};
  for (const RunProgram& program : record.programs) names.push_back(csvField(program.name));
  record.tracks.eachRow([&](const TrackFrame& frame, const TrackRow& row) {
    fmt::format_to(std::back_inserter(part), FMT_COMPILE("{},{},"), frame.frame, row.robot);
    appendNumber(part, static_cast<double>(row.x), kPerMetre, 4);
    part.push_back(',');
    appendNumber(part, static_cast<double>(row.y), kPerMetre, 4);
    part.push_back(',');
    appendFixed(part, frame.utime - record.start_utime, 6);
    part.push_back(',');
    appendNumber(part, static_cast<double>(row.theta), kPerRadian, 6);
    part.push_back(',');
    part.append(names[static_cast<std::size_t>(row.program + 1)]);
    fmt::format_to(std::back_inserter(part), FMT_COMPILE(",{},"), row.segment);
    part.append(stateText(row.state));
    part.push_back(',');
    part.append(contactText(row));
    for (const auto& [value, scale, decimals] :
         {std::tuple(row.light_front, kPerLight, 4), std::tuple(row.light_back, kPerLight, 4),
          std::tuple(row.stitched_x, kPerMetre, 4), std::tuple(row.stitched_y, kPerMetre, 4)}) {
      part.push_back(',');
      appendNumber(part, static_cast<double>(value), scale, decimals);
    }
    part.push_back('\n');
    if (part.size() >= kPart_bytes) write();
  });
  write();
}

}  // namespace lab::report
