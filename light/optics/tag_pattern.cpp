#include "light/optics/tag_pattern.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace lab::optics {
namespace {

struct FamilyEntry {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr std::array<FamilyEntry, 5> kFamilies{
    {{"tag36h11", tag36h11_create, tag36h11_destroy},
     {"tag25h9", tag25h9_create, tag25h9_destroy},
     {"tag16h5", tag16h5_create, tag16h5_destroy},
     {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
     {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy}}};

}  // namespace

std::vector<std::string> tagFamilies() {
  std::vector<std::string> names;
  for (const FamilyEntry& family : kFamilies) names.emplace_back(family.name);
  return names;
}

TagFamily::TagFamily(std::string_view name) {
  const auto* entry = std::find_if(kFamilies.begin(), kFamilies.end(),
                                   [&](const FamilyEntry& one) { return name == one.name; });
  if (entry == kFamilies.end()) {
    throw std::invalid_argument("no family of tags has the name " + std::string(name));
  }
  family_ = {entry->create(), entry->destroy};
}

int TagFamily::size() const { return static_cast<int>(family_->ncodes); }

/// As apriltag_to_image(), whose result cannot be freed with Debian's library.
TagPattern TagFamily::pattern(int tag) const {
  const apriltag_family_t& family = *family_;
  if (tag < 0 || tag >= size()) {
    throw std::out_of_range("the family " + std::string(family.name) + " has no tag " +
                            std::to_string(tag));
  }
  TagPattern pattern;
  pattern.cells = family.total_width;
  pattern.half_square = family.width_at_border / 2.0;
  const auto cells = static_cast<std::size_t>(pattern.cells);
  pattern.dark.assign(cells * cells, 1);
  const int ring = family.width_at_border + (family.reversed_border ? 0 : 2);
  const int from = (pattern.cells - ring) / 2;
  const auto whiten = [&](int column, int row) {
    pattern.dark[static_cast<std::size_t>(row) * cells + static_cast<std::size_t>(column)] = 0;
  };
  for (int i = 0; i < ring; ++i) {
    whiten(from + i, from);
    whiten(from + i, from + ring - 1);
    whiten(from, from + i);
    whiten(from + ring - 1, from + i);
  }
  const int border = (pattern.cells - family.width_at_border) / 2;
  const std::uint64_t code = family.codes[tag];
  for (std::uint32_t i = 0; i < family.nbits; ++i) {
    if ((code >> (family.nbits - i - 1) & 1) == 0) continue;
    whiten(static_cast<int>(family.bit_x[i]) + border, static_cast<int>(family.bit_y[i]) + border);
  }
  return pattern;
}

}  // namespace lab::optics
