/// What is wrong with an experiment file, collected until everything has been looked at.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace lab::keys {

/// Where something stands.
struct FileLocation {
  std::string text;      ///< "experiments/x.toml:12" or "--set duration_s=abc"
  std::size_t line = 0;  ///< for the order, 0: not in the file
};

/// Paths of keys are written as for --set: "robots[2].x_cm".
class Problems {
 public:
  using Locate = std::function<FileLocation(const std::string& path)>;

  /// @param locate finds the place of a path, or of the nearest thing around it that is there.
  explicit Problems(Locate locate) : locate_(std::move(locate)) {}

  /// @param what "found 130, allowed 3.75 to 116.25 (inside the arena)".
  void add(const std::string& path, std::string what);

  /// add() of something that stands elsewhere than its path says.
  void addAt(FileLocation place, std::string path, std::string what);

  /// Whether the path, something in it or something around it is already known to be wrong, so
  /// that further conclusions from it would only confuse.
  [[nodiscard]] bool concern(const std::string& path) const;

  [[nodiscard]] bool empty() const { return problems_.empty(); }

  /// One line a problem, in the order of the file, at most `most` and how many more there are.
  [[nodiscard]] std::vector<std::string> lines(std::size_t most) const;

 private:
  struct Problem {
    FileLocation place;
    std::string path;
    std::string what;
  };

  Locate locate_;
  std::vector<Problem> problems_;
};

}  // namespace lab::keys
