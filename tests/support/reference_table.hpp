/// Reads tables of tests/reference.
#pragma once

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace lab::analysis {

/// The rows of a reference table, without comments and column names, split at commas.
inline std::vector<std::vector<std::string>> readTable(const std::string& name) {
  const std::string path = LAB_REFERENCE_DIRECTORY "/" + name;
  std::ifstream file(path);
  if (!file) {
    throw std::runtime_error("cannot read " + path);
  }
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#' || line.rfind("tau_s", 0) == 0 ||
        line.rfind("set,", 0) == 0) {
      continue;
    }
    std::vector<std::string> row;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) {
      row.push_back(field);
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace lab::analysis
