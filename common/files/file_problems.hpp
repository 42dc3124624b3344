/// Collects the problems of an experiment file, so that all are reported at once.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace lab::keys {

/// A location in a file or in an override.
struct FileLocation {
  std::string text;      ///< "experiments/x.toml:12" or "--set duration_s=abc"
  std::size_t line = 0;  ///< for sorting, 0: not in the file
};

/// The problems found in a file. Paths of keys are written as for --set: "robots[2].x_cm".
class Problems {
 public:
  using Locate = std::function<FileLocation(const std::string& path)>;

  /// @param locate finds the location of a path, or of the innermost existing element that contains
  /// it
  explicit Problems(Locate locate) : locate_(std::move(locate)) {}

  /// @param what "found 130, allowed 3.75 to 116.25 (inside the arena)"
  void add(const std::string& path, std::string what);

  /// As add(), with an explicit location.
  void addAt(FileLocation place, std::string path, std::string what);

  /// Whether the path, an element in it or an element around it has a problem. Further checks of it
  /// would give misleading messages.
  [[nodiscard]] bool concern(const std::string& path) const;

  [[nodiscard]] bool empty() const { return problems_.empty(); }

  /// One line per problem, in the order of the file: at most `most`, then the number of omitted
  /// ones.
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
