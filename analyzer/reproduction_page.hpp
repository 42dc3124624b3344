/// reproduction.html: the paper's figures 2, 3 and 4, reproduced by this lab.
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

/// The written page and a summary.
struct WrittenReproduction {
  std::filesystem::path page;
  std::vector<std::string> lines;  ///< for the terminal: one line per panel that tests something
};

/// Writes reproduction.html, estimates.csv and every panel as SVG, PDF and CSV into the folder,
/// with the same bytes for the same recordings.
/// @throws ReportError if gnuplot is missing or the folder cannot be written.
[[nodiscard]] WrittenReproduction writeReproduction(const std::filesystem::path& out,
                                                    const std::vector<PaperPanel>& panels,
                                                    const Reproduction& reproduction,
                                                    const ReproductionFacts& facts);

}  // namespace lab::report
