/// When the pictures of a folder were taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lab::cameras {

/// Times in seconds by frame number, from a table with columns frame and t_s among others, as
/// spreadsheets write it too.
class FrameTable {
 public:
  /// @throws CameraError with file and line: empty, columns missing, no number, numbers or times
  /// that
  ///   do not grow
  explicit FrameTable(const std::filesystem::path& file);

  /// @throws CameraError: the table has no such frame
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
