#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lab {

/// What the file of a program says of its law (docs/programs.md).
struct LawText {
  /// Name of a closed form (analyzer/laws/); empty: none is named.
  std::string name;
  /// Parameters of the closed form with their values, SI units.
  std::vector<std::pair<std::string, double>> parameters;
  /// Own formulas of the program's parameters and the lag `tau`; empty: none.
  std::string msd;
  std::string angular_msd;
  std::string diffusivity;
  std::string rotational_diffusivity;

  bool operator==(const LawText&) const = default;
};

}  // namespace lab
