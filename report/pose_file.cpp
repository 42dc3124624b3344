#include "report/pose_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <vector>

#include "common/units.hpp"
#include "report/report_error.hpp"

namespace lab::report {
namespace {

constexpr double kLeastConfidence = 0.5;  // as for poses from the bus
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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

/// A column and what it is called in this file.
struct Column {
  std::string name;
  std::size_t index = 0;
  [[nodiscard]] explicit operator bool() const { return !name.empty(); }
};

struct Row {
  std::int64_t line = 0;
  std::int64_t frame = 0;
  double time = 0;  ///< [s]
  analysis::FramePose pose;
};

class Reader {
 public:
  Reader(const std::string& name, const PoseFileOptions& options)
      : name_(name), options_(options) {}

  PoseFile read(std::istream& text) {
    std::string line;
    readHeader(text, line);
    while (std::getline(text, line)) {
      ++line_;
      if (trimmed(line).empty()) continue;
      split(line, separator_, fields_);
      readRow();
    }
    if (text.bad()) throw ReportError(name_ + ": cannot be read to its end");
    if (rows_.empty()) {
      throw ReportError(fmt::format("{}: found no pose in {} rows; expected at least one robot",
                                    name_, file_.rows));
    }
    collectFrames();
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(std::int64_t line, const std::string& what) const {
    throw ReportError(fmt::format("{}:{}: {}", name_, line, what));
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

  void readHeader(std::istream& text, std::string& line) {
    std::getline(text, line);
    line_ = 1;
    constexpr std::string_view kMark = "\xEF\xBB\xBF";  // of UTF-8, as spreadsheets write it
    std::string_view header = line;
    if (header.starts_with(kMark)) header.remove_prefix(kMark.size());
    separator_ = separatorOf(header);
    split(header, separator_, fields_);
    columns_ = fields_.size();
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
    file_.headings = static_cast<bool>(theta_);
    if (!frame_ || !id_ || !x_ || !y_) {
      fail(1,
           fmt::format("found the columns \"{}\"; expected frame, id or particle, and x_cm, y_cm "
                       "(or x, y with --scale-cm)",
                       fmt::join(fields_, "\", \"")));
    }
    if (!file_.in_arena) {
      if (!options_.scale) {
        fail(1,
             "x, y: found no unit; expected columns x_cm, y_cm, or --scale-cm with the length of "
             "one unit of x and y in cm (of a pixel, say)");
      }
      unit_ = *options_.scale;
    }
    if (!time_ && !options_.fps) {
      fail(1,
           "found no column of times; expected t_s, t or time in s, or --fps with the frames per "
           "second");
    }
  }

  /// nan for an empty field and for "nan".
  [[nodiscard]] double number(const Column& column) const {
    const std::string_view text = fields_[column.index];
    if (text.empty() || text == "nan" || text == "NaN" || text == "NA") return kNan;
    double value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + (text.front() == '+'), end, value);
    if (error != std::errc() || stop != end || !std::isfinite(value)) {
      fail(line_, fmt::format("{}: found \"{}\", expected a number", column.name, text));
    }
    return value;
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
    if (fields_.size() != columns_) {
      fail(line_, fmt::format("found {} fields, expected {} as in the first line", fields_.size(),
                              columns_));
    }
    ++file_.rows;
    Row row;
    row.line = line_;
    row.frame = whole(frame_);
    row.time = time_ ? number(time_) : static_cast<double>(row.frame) / *options_.fps;
    if (!std::isfinite(row.time)) {
      fail(line_, fmt::format("{}: found no number, expected a time in s", time_.name));
    }
    const std::int64_t id = whole(id_);
    if (id < std::numeric_limits<int>::min() || id > std::numeric_limits<int>::max()) {
      fail(line_, fmt::format("{}: found {}, expected a smaller number", id_.name, id));
    }
    row.pose.robot = static_cast<int>(id);
    row.pose.x = number(x_) * unit_;
    row.pose.y = number(y_) * unit_;
    row.pose.theta = theta_ ? number(theta_) : 0;
    row.pose.valid = !confidence_ || number(confidence_) >= kLeastConfidence;
    if (!std::isfinite(row.pose.x + row.pose.y + row.pose.theta)) {
      ++file_.without_pose;
    } else if (id == 0 && file_.in_arena) {
      ++file_.without_id;
    } else {
      rows_.push_back(row);
    }
  }

  void collectFrames() {
    std::stable_sort(rows_.begin(), rows_.end(),
                     [](const Row& a, const Row& b) { return a.frame < b.frame; });
    std::int64_t least_step = std::numeric_limits<std::int64_t>::max();
    std::vector<double> periods;
    for (const Row& row : rows_) {
      if (file_.frames.empty() || file_.frames.back().frame != row.frame) {
        if (!file_.frames.empty()) {
          const analysis::Frame& last = file_.frames.back();
          if (!(row.time > last.time)) {
            fail(row.line, fmt::format("{}: found {} s in frame {}, expected more than the {} s of "
                                       "frame {}",
                                       time_.name, row.time, row.frame, last.time, last.frame));
          }
          least_step = std::min(least_step, row.frame - last.frame);
          periods.push_back(row.time - last.time);
        }
        file_.frames.push_back({row.time, row.frame, {}});
      } else if (row.time != file_.frames.back().time) {
        fail(row.line, fmt::format("{}: found {} s, expected {} s as in the other rows of frame {}",
                                   time_.name, row.time, file_.frames.back().time, row.frame));
      }
      file_.frames.back().poses.push_back(row.pose);
    }
    if (periods.empty()) return;
    const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
    std::nth_element(periods.begin(), middle, periods.end());
    file_.frame_period = *middle;
    // A film of which every n-th picture was tracked is whole.
    const std::int64_t span = file_.frames.back().frame - file_.frames.front().frame;
    file_.missing_frames = span / least_step + 1 - static_cast<std::int64_t>(file_.frames.size());
  }

  const std::string& name_;
  const PoseFileOptions& options_;
  PoseFile file_;
  std::vector<Row> rows_;
  Fields fields_;
  std::size_t columns_ = 0;
  std::int64_t line_ = 0;
  char separator_ = ',';
  double unit_ = 1;  ///< [m]
  Column frame_, id_, x_, y_, time_, theta_, confidence_;
};

}  // namespace

PoseFile readPoses(std::istream& text, const std::string& name, const PoseFileOptions& options) {
  return Reader(name, options).read(text);
}

PoseFile readPoses(const std::filesystem::path& file, const PoseFileOptions& options) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw ReportError(fmt::format("{}: {}", file.string(), std::strerror(errno)));
  return readPoses(stream, file.string(), options);
}

}  // namespace lab::report
