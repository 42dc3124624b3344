#include "tracker_svc/cameras/frame_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string_view>

#include "common/camera/cameras.hpp"
#include "common/files/file_text.hpp"

namespace lab::cameras {
namespace {

namespace fs = std::filesystem;

// spreadsheets write it at the start of tables
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr const char* kBlanks = " \t\r";

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    const std::size_t first = cell.find_first_not_of(kBlanks);
    const std::size_t last = cell.find_last_not_of(kBlanks);
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

}  // namespace

FrameTable::FrameTable(const fs::path& file) : name_(file.string()) {
  FileContent content = readRegularFile(file, file_kinds::kFrameTable);
  if (!content.text) throw CameraError(name_ + ": " + content.problem);
  std::istringstream stream(*std::move(content.text));
  std::string line;
  if (!std::getline(stream, line)) fail("is empty, expected a line of column names");
  if (line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
  const std::vector<std::string> columns = split(line);
  frame_ = column(columns, "frame");
  time_ = column(columns, "t_s");
  while (std::getline(stream, line)) {
    ++line_;
    if (!line.empty() && line != "\r") add(split(line));
  }
}

double FrameTable::at(std::int64_t frame, const fs::path& picture) const {
  const auto row = times_.find(frame);
  if (row == times_.end()) {
    throw CameraError(name_ + ": has no row for frame " + std::to_string(frame) + " (" +
                      picture.filename().string() + ")");
  }
  return row->second;
}

void FrameTable::fail(const std::string& what) const {
  throw CameraError(name_ + ":" + std::to_string(line_) + ": " + what);
}

std::size_t FrameTable::column(const std::vector<std::string>& columns,
                               const std::string& title) const {
  const auto found = std::find(columns.begin(), columns.end(), title);
  if (found == columns.end()) fail("has no column " + title + ", expected frame and t_s");
  return static_cast<std::size_t>(found - columns.begin());
}

double FrameTable::value(const std::vector<std::string>& cells, std::size_t index,
                         const char* title) const {
  const std::string cell = index < cells.size() ? cells[index] : "";
  double found = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), found);
  const bool whole = error == std::errc() && end == cell.data() + cell.size();
  if (!whole || !std::isfinite(found)) {
    fail(std::string(title) + ": found \"" + cell + "\", expected a number");
  }
  return found;
}

void FrameTable::add(const std::vector<std::string>& cells) {
  // limit: three thousand years in seconds, more frames than any recording
  constexpr double kMost = 1e11;
  const double number = value(cells, frame_, "frame");
  const double time = value(cells, time_, "t_s");
  if (number != std::floor(number)) fail("frame: found a fraction, expected a whole number");
  if (std::abs(number) > kMost || std::abs(time) > kMost) {
    fail("frame and t_s: allowed -1e11 to 1e11");
  }
  const auto frame = static_cast<std::int64_t>(number);
  if (!times_.empty() && !(frame > times_.rbegin()->first && time > times_.rbegin()->second)) {
    fail("frame and t_s must increase from row to row");
  }
  times_[frame] = time;
}

}  // namespace lab::cameras
