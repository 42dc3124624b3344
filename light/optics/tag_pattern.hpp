/// The patterns of AprilTags, from libapriltag.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

struct apriltag_family;

namespace lab::optics {

/// Cells of a tag, black or white, with the white margin that belongs to its pattern.
struct TagPattern {
  int cells = 0;  ///< along each side
  double half_square =
      0;  ///< [cells] half the side of the square at the border, where white and black meet
  std::vector<float> dark;  ///< [1] 1: black; rows from the top, `cells` each

  [[nodiscard]] float at(int column, int row) const {
    return dark[static_cast<std::size_t>(row) * static_cast<std::size_t>(cells) +
                static_cast<std::size_t>(column)];
  }
};

/// Names of the families, the default first.
[[nodiscard]] std::vector<std::string> tagFamilies();

/// A family of tags.
class TagFamily {
 public:
  /// @throws std::invalid_argument if libapriltag has no family of this name
  explicit TagFamily(std::string_view name);

  [[nodiscard]] int size() const;

  /// @param tag 0 to size() - 1
  /// @throws std::out_of_range
  [[nodiscard]] TagPattern pattern(int tag) const;

  [[nodiscard]] apriltag_family* get() const { return family_.get(); }

 private:
  std::shared_ptr<apriltag_family> family_;
};

}  // namespace lab::optics
