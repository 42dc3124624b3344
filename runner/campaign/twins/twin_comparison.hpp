/// Places the numbers of a run within those of its twins. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lab::runner::campaign {

/// One number of a run, and the same of its twins. nan: not measured.
struct Look {
  std::string name;  ///< "NAME.D_r_rad2_s", "NAME.msd at 1 s (cm²)"
  double run = 0;
  std::vector<double> twins;
};

/// A look, placed.
struct PlacedLook {
  std::string name;
  double run = 0;
  double mean = 0;   ///< of the twins
  double sigma = 0;  ///< standard deviation of the twins
  double low95 = 0;  ///< interval that holds 95 % of further twins
  double high95 = 0;
  int below = 0;     ///< twins below the run
  int above = 0;     ///< twins above the run
  double z = 0;      ///< normal deviate of the run; nan: the twins do not vary
  double p = 0;      ///< two-sided, of this look alone
  double p_all = 0;  ///< the same with the number of looks taken into account
};

struct TwinComparison {
  int twins = 0;
  std::vector<PlacedLook> looks;    ///< in the order given
  std::vector<std::string> absent;  ///< looks that the run or most twins do not have
  double p = 1;          ///< probability that a twin has as large a largest |z| as the run
  std::size_t most = 0;  ///< index of the look with the smallest p_all
};

/// Compares. Numbers are compared as they are, by their cube roots or by their logarithms,
/// whichever the twins have the least skewness of. A deviate is that of Student's t for a further
/// draw beside the twins. The number of looks is taken into account by the distribution of the
/// largest |z| of correlated normal numbers, with the correlation of the twins, shrunk towards none
/// because few twins know it badly; or by the twins' own largest |z|, each compared with the
/// others, if that gives the larger probability.
/// @param looks all with the same number of twins, at least 5
/// @param seed of the simulated numbers
[[nodiscard]] TwinComparison compareWithTwins(const std::vector<Look>& looks,
                                              std::uint64_t seed = 1);

/// The looks of a summary.json: estimates, shares, and curves at one lag per octave. In the same
/// order for a run and its twins; a program that a summary lacks gives nan.
struct SummaryLook {
  std::string name;
  double value = 0;
};
[[nodiscard]] std::vector<SummaryLook> looksOf(std::string_view summary_json);

/// Combines the summaries of a run and of its twins: the looks of the run decide.
[[nodiscard]] std::vector<Look> looksOf(std::string_view run,
                                        const std::vector<std::string>& twins);

}  // namespace lab::runner::campaign
