#include "runner/command_line/build_facts.hpp"

#include <dds/version.h>
#include <fmt/format.h>
#include <lcm/lcm.h>
#include <spdlog/version.h>

#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "common/process/version.hpp"
#include "runner/command_line/revision.hpp"

namespace lab::runner {

std::string buildFacts() {
  const auto known = [](const std::string& text) { return text.empty() ? "not known" : text; };
  std::string facts = fmt::format("Active Lab {}\n", kVersion);
  const auto line = [&facts](const char* name, const std::string& value) {
    facts += fmt::format("{:<10} {}\n", name, value);
  };
  line("revision", known(sourceRevision()));
  line("of", known(sourceDate()));
  line("contract", std::to_string(kContractVersion));
  line("compiler", LAB_COMPILER);
  line("build", LAB_BUILD_TYPE);
  line(
      "libraries",
      fmt::format("LCM {}.{}.{}, Cyclone DDS {}, Eigen {}.{}.{}, fmt {}.{}.{}, spdlog {}.{}.{}, "
                  "nlohmann-json {}.{}.{}, CLI11 {}",
                  LCM_MAJOR_VERSION, LCM_MINOR_VERSION, LCM_MICRO_VERSION, DDS_VERSION,
                  EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION,
                  FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100, SPDLOG_VER_MAJOR,
                  SPDLOG_VER_MINOR, SPDLOG_VER_PATCH, NLOHMANN_JSON_VERSION_MAJOR,
                  NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH, CLI11_VERSION));
  facts.pop_back();
  return facts;
}

}  // namespace lab::runner
