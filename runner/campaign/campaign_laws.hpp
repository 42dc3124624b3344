/// What a campaign says about its quantities: which vary, whether they follow the exact law, and
/// their power laws. Pure functions.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "runner/campaign/campaign_table.hpp"
#include "runner/campaign/power_law.hpp"

namespace lab::runner::campaign {

/// A quantity's name for people.
struct QuantityLabel {
  std::string program;  ///< empty: none
  std::string symbol;   ///< "D_r"
  std::string unit;     ///< "rad²/s"; empty: none

  [[nodiscard]] std::string text() const;  ///< "D_r of NAME (rad²/s)"
};

[[nodiscard]] QuantityLabel labelOf(const std::string& quantity);

/// The name of a parameter as a letter: "eta" is "η".
[[nodiscard]] std::string letterOf(const std::string& name);

/// The quantities to draw (indices): those named, else estimates, at most `most`: first those whose
/// exact law varies over the points, then those that vary most.
/// @param shown names; a last part is enough ("D_r_rad2_s")
/// @throws UserError for a name that is not there
[[nodiscard]] std::vector<std::size_t> leadingQuantities(const PooledTable& pooled,
                                                         const std::vector<std::string>& shown,
                                                         std::size_t most);

/// How far a mean is from the law, as the normal deviate of the same probability; nan: not known.
[[nodiscard]] double deviateFrom(const PooledNumber& number, double theory);

/// Comparison of a quantity with the exact law at all points.
struct LawAgreement {
  int points = 0;      ///< that have an interval and a law
  int held = 0;        ///< of these, the interval holds the law's value
  double chi2 = 0;     ///< of all deviates
  double p = 0;        ///< P(chi2 or more)
  double largest = 0;  ///< largest |deviate|, in standard errors
};
[[nodiscard]] LawAgreement agreementOf(const PooledTable& pooled, std::size_t quantity);

/// The power law of a quantity in the swept keys.
struct CampaignPowerLaw {
  std::vector<std::size_t> axes;  ///< whose keys it has
  PowerLaw measured;
  /// That of the exact law, if it is one (within 1 % at every point).
  std::optional<PowerLaw> exact;
};

/// @return nothing if a swept key is no positive number, or the fit does not exist
[[nodiscard]] std::optional<CampaignPowerLaw> powerLawOf(const CampaignData& data,
                                                         const PooledTable& pooled,
                                                         std::size_t quantity);

}  // namespace lab::runner::campaign
