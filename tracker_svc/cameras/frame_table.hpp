/// Time stamps of the pictures in a folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lab::cameras {

/// Times in seconds by frame number, from a CSV table with the columns frame and t_s, possibly
/// among others and possibly written by a spreadsheet.
class FrameTable {
 public:
  /// @throws CameraError with file and line if it is empty, columns are missing, a value is no
  ///   number, or numbers or times do not increase
  explicit FrameTable(const std::filesystem::path& file);

  /// @throws CameraError if the table has no such frame
  [[nodiscard]] double at(std::int64_t frame, const std::filesystem::path& picture) const;

 private:
  [[noreturn]] void fail(const std::string& what) const;
  [[nodiscard]] std::size_t column(const std::vector<std::string>& columns,
                                   const std::string& title) const;
  [[nodiscard]] double value(const std::vector<std::string>& cells, std::size_t index,
                             const char* title) const;
  void add(const std::vector<std::string>& cells);

  std::string name_;
  int line_ = 1;
  std::size_t frame_ = 0;
  std::size_t time_ = 0;
  std::map<std::int64_t, double> times_;
};

}  // namespace lab::cameras
