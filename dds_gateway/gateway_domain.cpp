#include "dds_gateway/gateway_domain.hpp"

#include <fstream>
#include <iterator>
#include <string>

#include "common/experiment/experiment_file.hpp"
#include "dds_gateway/dds/configuration.hpp"
#include "dds_gateway/dds/error.hpp"

namespace lab::gateway {
namespace fs = std::filesystem;
namespace {

std::string textOfFile(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) {
    throw ExperimentError({file.string() + ": gateway.configuration cannot be read: is it there?"});
  }
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

dds::Domain joinDomain(const Gateway& gateway, const fs::path& directory) {
  std::string where = "gateway";
  try {
    if (!gateway.configuration.empty()) {
      where = "gateway.configuration";
      const fs::path file = directory / gateway.configuration;
      return {gateway.domain, textOfFile(file), where + " (" + file.string() + ")"};
    }
    if (gateway.address.empty()) return {gateway.domain, dds::localConfiguration(), where};
    where = "gateway.address";
    const fs::path security = gateway.security;
    return {gateway.domain,
            dds::networkConfiguration(
                {.address = gateway.address,
                 .peers = gateway.peers,
                 .security = security.empty() ? "" : (directory / security).string()}),
            where};
  } catch (const dds::DdsError& error) {
    const std::string what = error.what();
    throw ExperimentError({what.starts_with(where) ? what : where + ": " + what});
  }
}

}  // namespace lab::gateway
