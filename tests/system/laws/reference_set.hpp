/// The exact tables of tests/reference in SI units.
#pragma once

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "analyzer/laws.hpp"
#include "robot/dynamics/robot_program.hpp"
#include "tests/support/reference_table.hpp"

namespace lab::system_test {

/// One exact table of tests/reference: a program, a frame rate and the two curves, in SI units.
struct ReferenceSet {
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
  set.law.v = numberIn(header, "v") * kCentimetre;
  set.law.va = numberIn(header, "va") * kCentimetre;
  set.law.V = numberIn(header, "V") * kCentimetre;
  set.law.epsilon = numberIn(header, "eps");
  set.law.eta = numberIn(header, "eta");
  set.law.gamma = numberIn(header, "gam");
  set.law.tau_t = numberIn(header, "tt");
  set.law.kind = kind("ABP")       ? analysis::ProgramKind::kAbp
                 : kind("RTP")     ? analysis::ProgramKind::kRtp
                 : set.law.va == 0 ? analysis::ProgramKind::kBp
                                   : analysis::ProgramKind::kNoisyAbp;
  for (const std::vector<std::string>& row : analysis::readTable(name + ".csv")) {
    set.lags.push_back(static_cast<int>(std::lround(std::stod(row.at(0)) * set.fps)));
    set.msd.push_back(std::stod(row.at(1)) * kCentimetre * kCentimetre);
    set.angular_msd.push_back(std::stod(row.at(4)));
  }
  return set;
}

/// The program as the robot receives it.
inline dynamics::ProgramParams paramsOf(const analysis::ProgramLaw& law) {
  const dynamics::ParamsResult result = dynamics::toProgramParams(law);
  if (!result.ok) {
    throw std::runtime_error(result.reason);
  }
  return result.params;
}

}  // namespace lab::system_test
