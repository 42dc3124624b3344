#include "analyzer/report/poses/pose_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "analyzer/report/poses/pose_frames.hpp"
#include "analyzer/report_error.hpp"
#include "common/files/file_text.hpp"
#include "common/math/units.hpp"

namespace lab::report {
namespace {

using units::kNan;

constexpr double kLeastConfidence = 0.5;  // as for poses from the bus
constexpr double kFarthest = 1000;        // [m] as for poses from the bus
constexpr double kLargestAngle = 1e6;     // [rad]
constexpr std::size_t kMostColumns = 4096;
constexpr std::size_t kLongestLine = std::size_t{1} << 20U;

using Fields = std::vector<std::string_view>;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\"";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

void split(std::string_view line, char separator, Fields& fields) {
  fields.clear();
  while (true) {
    const std::size_t end = line.find(separator);
    fields.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
  }
}

char separatorOf(std::string_view header) {
  for (const char separator : {',', ';', '\t'}) {
    if (header.find(separator) != std::string_view::npos) return separator;
  }
  return ',';
}

/// A column and its name in this file.
struct Column {
  std::string name;
  std::size_t index = 0;
  [[nodiscard]] explicit operator bool() const { return !name.empty(); }
};

class Reader {
 public:
  Reader(std::string name, const PoseFileOptions& options)
      : name_(std::move(name)), options_(options) {}

  /// Sets the file name for messages.
  void rename(std::string name) {
    name_ = std::move(name);
    line_ = 0;
  }

  /// Reads one file. `robot` is the id if the file has no ids.
  void read(std::istream& text, int robot = 0) {
    std::string line;
    default_robot_ = robot;
    readHeader(text, line);
    while (nextLine(text, line)) {
      if (trimmed(line).empty()) continue;
      split(line, separator_, fields_);
      readRow();
    }
    if (text.bad()) throw ReportError(name_ + ": cannot be read to its end");
  }

  PoseFile finish() {
    dropWithoutHeading();
    if (rows_.empty()) {
      throw ReportError(fmt::format("{}: found no pose in {} rows; expected at least one robot",
                                    name_, file_.rows));
    }
    collectFrames(std::move(rows_), {name_, id_ ? id_.name : "id", timeName(), timeHint()}, file_);
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(std::int64_t line, const std::string& what) const {
    throw ReportError(fmt::format("{}:{}: {}", name_, line, what));
  }

  /// As std::getline(), for lines of limited length. @return whether there was a line
  bool nextLine(std::istream& text, std::string& line) {
    ++line_;
    text.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    const auto got = static_cast<std::size_t>(text.gcount());
    if (text.fail() && got + 1 == buffer_.size()) {
      fail(line_, "found a line of more than 1 MB, expected rows of numbers");
    }
    if (text.fail()) return false;
    line.assign(buffer_.data(), got - (text.eof() ? 0 : 1));
    return true;
  }

  [[nodiscard]] Column find(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names) {
      const auto found = std::find(fields_.begin(), fields_.end(), name);
      if (found != fields_.end()) {
        return {std::string(name), static_cast<std::size_t>(found - fields_.begin())};
      }
    }
    return {};
  }

  /// Leaves out rows without a heading; if these are most of them, as of round blobs, the headings.
  void dropWithoutHeading() {
    const auto unknown = [](const PoseRow& row) { return !std::isfinite(row.pose.theta); };
    std::size_t known = 0;
    rows_.each([&](const PoseRow& row) { known += unknown(row) ? 0U : 1U; });
    if (known == rows_.size()) return;
    if (2 * known >= rows_.size()) {
      file_.without_pose += static_cast<std::int64_t>(rows_.size() - known);
      std::size_t kept = 0;
      rows_.each([&](const PoseRow& row) {
        if (!unknown(row)) rows_[kept++] = row;
      });
      rows_.shrink(kept);
      return;
    }
    file_.headings = false;
    rows_.each([](PoseRow& row) { row.pose.theta = 0; });
  }

  void readHeader(std::istream& text, std::string& line) {
    line_ = 0;
    line.clear();
    nextLine(text, line);
    constexpr std::string_view kMark =
        "\xEF\xBB\xBF";  // UTF-8 byte order mark, as spreadsheets write it
    std::string_view header = line;
    if (header.starts_with(kMark)) header.remove_prefix(kMark.size());
    const auto isControl = [](char c) {
      return static_cast<unsigned char>(c) < 32 && c != '\t' && c != '\r';
    };
    if (std::any_of(header.begin(), header.end(), isControl)) {
      fail(1,
           "found bytes that are no letters, expected a text of columns in UTF-8 (is it in UTF-16, "
           "or no CSV file?)");
    }
    separator_ = separatorOf(header);
    split(header, separator_, fields_);
    columns_ = fields_.size();
    if (columns_ > kMostColumns) {
      fail(1, fmt::format("found {} columns, expected at most {}", columns_, kMostColumns));
    }
    // "X#wcentroid (cm)" of TRex.
    for (std::string_view& field : fields_) {
      const std::size_t bracket = field.find('(');
      if (bracket == std::string_view::npos || bracket == 0) continue;
      const std::string_view unit = field.substr(bracket);
      const bool place = field.starts_with('X') || field.starts_with('Y');
      if (place && unit != "(cm)" && !options_.scale) {
        fail(1,
             fmt::format("{}: found a place that is not in cm; expected --scale-cm with the length "
                         "of its unit in cm",
                         field));
      }
      field = trimmed(field.substr(0, bracket));
    }
    if (findWide()) return;
    frame_ = find({"frame"});
    id_ = find({"id", "particle"});
    x_ = find({"x_cm"});
    y_ = find({"y_cm"});
    file_.in_arena = x_ && y_;
    unit_ = units::kCentimetre;
    if (!file_.in_arena) {
      x_ = find({"x"});
      y_ = find({"y"});
    }
    time_ = find({"t_s", "t", "time"});
    theta_ = find({"theta_rad", "theta"});
    confidence_ = find({"confidence"});
    missing_ = find({"missing"});
    findTrex();
    file_.headings = static_cast<bool>(theta_);
    file_.times = static_cast<bool>(time_);
    if (!frame_ || !(id_ || trex_) || !x_ || !y_) {
      fail(1,
           fmt::format("found the columns \"{}\"; expected frame, id or particle, and x_cm, y_cm "
                       "(or x, y with --scale-cm), or those of TRex: frame, X#wcentroid, "
                       "Y#wcentroid, time; separated by commas, semicolons or tabs",
                       fmt::join(fields_, "\", \"")));
    }
    if (trex_) {
      unit_ = options_.scale.value_or(units::kCentimetre);
    } else if (!file_.in_arena) {
      if (!options_.scale) {
        fail(1,
             "x, y: found no unit; expected columns x_cm, y_cm, or --scale-cm with the length of "
             "one unit of x and y in cm (of a pixel, say)");
      }
      unit_ = *options_.scale;
    }
    if (time_ && options_.fps) {
      fail(1,
           fmt::format("{}: found a column of times beside --fps, expected one of them: leave out "
                       "what is wrong",
                       time_.name));
    }
    if (!time_ && !options_.fps) {
      fail(1,
           "found no column of times; expected t_s, t or time in s, or --fps with the frames per "
           "second");
    }
  }

  /// Finds the columns of idtracker.ai: x1, y1, x2, y2 ... in pixels, one row for each frame.
  bool findWide() {
    wide_.clear();
    for (int robot = 1;; ++robot) {
      const Column x = find({"x" + std::to_string(robot)});
      const Column y = find({"y" + std::to_string(robot)});
      if (!x || !y) break;
      wide_.emplace_back(x, y);
    }
    if (wide_.empty() || find({"frame"})) return false;
    time_ = find({"time", "seconds"});
    file_.times = static_cast<bool>(time_);
    if (!options_.scale) {
      fail(1, "x1, y1: found places in pixels; expected --scale-cm with the size of a pixel in cm");
    }
    if (static_cast<bool>(time_) == options_.fps.has_value()) {
      fail(1, fmt::format("found {}; expected a column time or --fps with the frames per second",
                          time_ ? "a column of times beside --fps" : "no column of times"));
    }
    unit_ = *options_.scale;
    return true;
  }

  /// Reads a row with all animals of one frame; lost ones are nan.
  void readWideRow() {
    const std::int64_t frame = file_.rows - 1;
    const double time = time_ ? number(time_) : static_cast<double>(frame) / *options_.fps;
    requireTime(time);
    for (std::size_t i = 0; i < wide_.size(); ++i) {
      PoseRow row;
      row.line = line_;
      row.frame = frame;
      row.time = time;
      row.pose.robot = static_cast<int>(i) + 1;
      row.pose.x = place(wide_[i].first);
      row.pose.y = place(wide_[i].second);
      row.pose.valid = true;
      if (!std::isfinite(row.pose.x + row.pose.y)) {
        ++file_.without_pose;
      } else {
        rows_.push_back(row);
      }
    }
  }

  /// Finds the columns of TRex: the middle of the body if exported, else the head (X and Y).
  void findTrex() {
    trex_ = false;
    if (x_ && y_) return;
    for (const std::string source : {"#wcentroid", "#centroid", "#pcentroid", "", "#head"}) {
      const std::string x = "X" + source;
      const std::string y = "Y" + source;
      x_ = find({x});
      y_ = find({y});
      if (x_ && y_) break;
    }
    trex_ = x_ && y_;
    if (!trex_) return;
    theta_ = find({"ANGLE", "ANGLE#head", "ANGLE#pcentroid", "ANGLE#wcentroid", "ANGLE#centroid"});
  }

  /// Source of the times, and the remedy if they are wrong.
  [[nodiscard]] std::string timeName() const { return time_ ? time_.name : "--fps"; }
  [[nodiscard]] const char* timeHint() const {
    return time_ ? "; times in other units: leave the column out and give --fps" : "";
  }

  void requireTime(double time) const {
    if (!std::isfinite(time)) {
      fail(line_, fmt::format("{}: found no number, expected a time in s", timeName()));
    }
    // About fifty times the seconds since 1970, so it excludes milliseconds and microseconds since
    // 1970.
    constexpr double kLatest = 1e11;
    if (!(std::abs(time) < kLatest)) {
      fail(line_, fmt::format("{}: found {} s, expected less than 1e11 s{}", timeName(), time,
                              timeHint()));
    }
  }

  /// nan for an empty field, for "nan" and for "inf".
  [[nodiscard]] double number(const Column& column) const {
    const std::string_view text = fields_[column.index];
    if (text.empty() || text == "nan" || text == "NaN" || text == "NA") return kNan;
    if (text == "inf" || text == "-inf" || text == "Infinity" || text == "-Infinity") return kNan;
    double value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + (text.front() == '+'), end, value);
    if (error != std::errc() || stop != end || !std::isfinite(value)) {
      const bool comma = text.find(',') != std::string_view::npos;
      fail(line_, fmt::format("{}: found \"{}\", expected a number{}", column.name, text,
                              comma ? " with a point, not a comma" : ""));
    }
    return value;
  }

  /// A coordinate [m], nan as number().
  [[nodiscard]] double place(const Column& column) const {
    const double value = number(column);
    if (std::abs(value * unit_) > kFarthest) {
      fail(line_, fmt::format("{}: found {}, more than 1 km away; expected a place in {}",
                              column.name, value, file_.in_arena ? "cm" : "units of --scale-cm"));
    }
    return value * unit_;
  }

  [[nodiscard]] std::int64_t whole(const Column& column) const {
    constexpr double kLargest = 1e15;
    const double value = number(column);
    if (!(std::abs(value) < kLargest) || value != std::floor(value)) {
      fail(line_, fmt::format("{}: found \"{}\", expected a whole number", column.name,
                              fields_[column.index]));
    }
    return static_cast<std::int64_t>(value);
  }

  void readRow() {
    // TRex may end its rows with columns that have no name.
    while (fields_.size() > columns_ && fields_.back().empty()) fields_.pop_back();
    if (fields_.size() != columns_) {
      fail(line_, fmt::format("found {} fields, expected {} as in the first line", fields_.size(),
                              columns_));
    }
    ++file_.rows;
    if (!wide_.empty()) return readWideRow();
    PoseRow row;
    row.line = line_;
    row.frame = whole(frame_);
    const bool seen = !missing_ || number(missing_) == 0;
    row.time = time_ ? number(time_) : static_cast<double>(row.frame) / *options_.fps;
    if (!seen && !std::isfinite(row.time)) {
      ++file_.without_pose;
      return;
    }
    requireTime(row.time);
    const std::int64_t id = id_ ? whole(id_) : default_robot_;
    if (id < std::numeric_limits<int>::min() || id > std::numeric_limits<int>::max()) {
      fail(line_, fmt::format("{}: found {}, expected a smaller number", id_.name, id));
    }
    row.pose.robot = static_cast<int>(id);
    row.pose.x = place(x_);
    row.pose.y = place(y_);
    row.pose.theta = theta_ ? number(theta_) : 0;
    if (std::abs(row.pose.theta) > kLargestAngle) {
      fail(line_, fmt::format("{}: found {}, expected an angle in rad, of at most 1e6", theta_.name,
                              row.pose.theta));
    }
    row.pose.valid = !confidence_ || number(confidence_) >= kLeastConfidence;
    if (!seen || !std::isfinite(row.pose.x + row.pose.y)) {
      ++file_.without_pose;
    } else if (id == 0 && file_.in_arena) {
      ++file_.without_id;
    } else {
      rows_.push_back(row);
    }
  }

  std::string name_;
  const PoseFileOptions& options_;
  PoseFile file_;
  DiskVector<PoseRow> rows_;
  std::vector<char> buffer_ = std::vector<char>(kLongestLine);
  Fields fields_;
  std::size_t columns_ = 0;
  std::int64_t line_ = 0;
  char separator_ = ',';
  double unit_ = 1;  ///< [m]
  Column frame_, id_, x_, y_, time_, theta_, confidence_, missing_;
  std::vector<std::pair<Column, Column>> wide_;  ///< x and y of each animal of idtracker.ai
  bool trex_ = false;                            ///< one individual per file
  int default_robot_ = 0;
};

/// 7 of NAME_fish7.csv and of NAME_id7.csv.
std::optional<int> trexNumber(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  for (const std::string_view mark : {"_fish", "_id"}) {
    const std::size_t at = stem.rfind(mark);
    if (at == std::string::npos) continue;
    int number = 0;
    const char* end = stem.data() + stem.size();
    const auto [stop, error] = std::from_chars(stem.data() + at + mark.size(), end, number);
    if (error == std::errc() && stop == end) return number;
  }
  return std::nullopt;
}

}  // namespace

PoseFile readPoses(std::istream& text, const std::string& name, const PoseFileOptions& options) {
  Reader reader(name, options);
  reader.read(text);
  return reader.finish();
}

std::vector<std::filesystem::path> trexFiles(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".csv" && trexNumber(entry.path())) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) {
    return std::pair(*trexNumber(a), a) < std::pair(*trexNumber(b), b);
  });
  return files;
}

PoseFile readPoses(const std::filesystem::path& file, const PoseFileOptions& options) {
  std::vector<std::filesystem::path> files{file};
  const bool folder = std::filesystem::is_directory(file);
  if (folder) files = trexFiles(file);
  if (files.empty()) {
    throw ReportError(
        fmt::format("{}: found no NAME_fish0.csv or NAME_id0.csv, the files that TRex "
                    "exports; expected a file of poses or a folder of these",
                    file.string()));
  }
  Reader reader(file.string(), options);
  for (const std::filesystem::path& one : files) {
    if (folder) {  // whatever lies in it: pipes and devices are not opened
      const std::string problem = regularFileProblem(one, {"a file of poses", UINTMAX_MAX});
      if (!problem.empty()) throw ReportError(fmt::format("{}: {}", one.string(), problem));
    }
    std::ifstream stream(one, std::ios::binary);
    if (!stream) throw ReportError(fmt::format("{}: {}", one.string(), std::strerror(errno)));
    reader.rename(one.string());
    reader.read(stream, trexNumber(one).value_or(0));
  }
  return reader.finish();
}

}  // namespace lab::report
