/// The lists in a message type, as tables.
#pragma once

#include <string>
#include <vector>

#include "common/schema/schema.hpp"

namespace lab::schema {

/// Lists of one struct that have the same number of elements, for it is the same field that counts
/// them. They are the columns of one table: in curve_t `lag`, `value`, `sigma`, ... are counted by
/// `num_lags` and make the table "lags".
struct ArrayGroup {
  std::string name;         ///< of a single list its own, else the counting field's without "num_"
  std::vector<int> fields;  ///< indices of the lists
  int count_field = -1;     ///< index
};

[[nodiscard]] std::vector<ArrayGroup> arrayGroups(const Type& type);

/// The tables of a type: "" are the messages themselves, "robots" the elements of a list of theirs,
/// "curves.lags" the elements of a list in those. The lists of a struct that is a single field have
/// its name before theirs: "orders.bands.program_code".
[[nodiscard]] std::vector<std::string> tablePaths(const Type& type);

}  // namespace lab::schema
