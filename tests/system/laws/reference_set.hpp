/// The exact tables of tests/reference in SI units.
#pragma once

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "analyzer/laws.hpp"
#include "tests/support/programs.hpp"
#include "tests/support/reference_table.hpp"

namespace lab::system_test {

/// One exact table of tests/reference: a program, a frame rate and the two curves, in SI units.
struct ReferenceSet {
  Program program;
  analysis::ProgramLaw law;
  double fps = 0;
  std::vector<int> lags;            ///< [frames]
  std::vector<double> msd;          ///< [m^2]
  std::vector<double> angular_msd;  ///< [rad^2]
};

/// The value of the key `name` in the first line of a table; 0 if it is missing.
inline double numberIn(const std::string& header, const std::string& name) {
  const std::string key = "\"" + name + "\": ";
  const auto at = header.find(key);
  if (at == std::string::npos || header.compare(at + key.size(), 4, "null") == 0) {
    return 0;
  }
  return std::stod(header.substr(at + key.size()));
}

/// @throws std::runtime_error if the table does not exist
inline ReferenceSet readReferenceSet(const std::string& name) {
  constexpr double kCentimetre = 0.01;
  std::ifstream file(std::string(LAB_REFERENCE_DIRECTORY) + "/" + name + ".csv");
  std::string header;
  if (!std::getline(file, header)) {
    throw std::runtime_error("cannot read the table " + name);
  }
  const auto kind = [&](const char* letters) {
    return header.find("\"kind\": \"" + std::string(letters) + "\"") != std::string::npos;
  };
  ReferenceSet set;
  set.fps = numberIn(header, "fps");
  const double v = numberIn(header, "v") * kCentimetre;
  const double va = numberIn(header, "va") * kCentimetre;
  const double width = numberIn(header, "V") * kCentimetre;
  const double epsilon = numberIn(header, "eps");
  set.program = kind("ABP")   ? test::abp(v, epsilon, numberIn(header, "eta"))
                : kind("RTP") ? test::rtp(v, numberIn(header, "gam"), numberIn(header, "tt"))
                : va == 0     ? test::bp(width, epsilon)
                              : test::noisyAbp(va, width, epsilon);
  set.law = analysis::lawOf(set.program, analysis::kPaperWheelBase);
  for (const std::vector<std::string>& row : analysis::readTable(name + ".csv")) {
    set.lags.push_back(static_cast<int>(std::lround(std::stod(row.at(0)) * set.fps)));
    set.msd.push_back(std::stod(row.at(1)) * kCentimetre * kCentimetre);
    set.angular_msd.push_back(std::stod(row.at(4)));
  }
  return set;
}

}  // namespace lab::system_test
