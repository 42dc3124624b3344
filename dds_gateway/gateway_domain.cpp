#include "dds_gateway/gateway_domain.hpp"

#include <string>
#include <utility>

#include "common/experiment/experiment_file.hpp"
#include "common/files/file_text.hpp"
#include "dds_gateway/dds/configuration.hpp"
#include "dds_gateway/dds/error.hpp"

namespace lab::gateway {
namespace fs = std::filesystem;

dds::Domain joinDomain(const Gateway& gateway, const fs::path& directory) {
  std::string where = "gateway";
  try {
    if (!gateway.configuration.empty()) {
      where = "--dds-configuration";
      const fs::path file = directory / gateway.configuration;
      return {gateway.domain, readFileText(file, file_kinds::kDdsConfiguration),
              where + " (" + file.string() + ")"};
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
