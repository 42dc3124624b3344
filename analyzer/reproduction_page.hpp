/// reproduction.html: the paper's figures 2, 3 and 4 as this lab gives them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "analyzer/report/reproduction/reproduction_results.hpp"

namespace lab::report {

struct ReproductionFacts {
  double hours = 1;
  std::uint64_t seed = 1;
  int ensemble = 1;
  bool through_firmware = false;
};

/// What came of it.
struct WrittenReproduction {
  std::filesystem::path page;
  std::vector<std::string> lines;  ///< for the terminal, one a panel that tests something
};

/// Writes reproduction.html, estimates.csv and every panel as SVG, PDF and CSV into the folder, to
/// the same bytes for the same recordings.
/// @throws ReportError when gnuplot is missing or the folder cannot be written.
[[nodiscard]] WrittenReproduction writeReproduction(const std::filesystem::path& out,
                                                    const std::vector<PaperPanel>& panels,
                                                    const Reproduction& reproduction,
                                                    const ReproductionFacts& facts);

}  // namespace lab::report
