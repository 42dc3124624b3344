/// What a program of motion says about its law.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lab {

/// Either the closed form that the program follows or formulas of its own. Empty: the reference of
/// its curves is simulated.
struct LawText {
  std::string name;  ///< closed form (analyzer/laws/), empty: none
  /// Of the closed form, in SI units.
  std::vector<std::pair<std::string, double>> parameters;
  std::string msd;                     ///< formula [cm^2], empty: none
  std::string angular_msd;             ///< formula [rad^2]
  std::string diffusivity;             ///< formula [cm^2/s]
  std::string rotational_diffusivity;  ///< formula [1/s]

  bool operator==(const LawText&) const = default;
};

}  // namespace lab
