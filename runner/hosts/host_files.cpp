#include "runner/hosts/host_files.hpp"

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <string_view>

#include "common/bus/log_file.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/files/certificate_folder.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr const char* kLinkSecurity = "security/link";
constexpr const char* kGatewaySecurity = "security/gateway";
constexpr const char* kMapping = "gateway/mapping";

/// Robots of one log share it.
std::string recordingName(const Experiment& e, const std::string& log) {
  const auto first = std::ranges::find(e.robots, log, &RobotSpec::log);
  return "recordings/" + std::to_string(first - e.robots.begin()) + ".lcmlog";
}

void addFolder(const fs::path& folder, const std::string& name, std::vector<HostFile>& files) {
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (!entry.is_regular_file()) continue;
    files.push_back(
        {(fs::path(name) / fs::relative(entry.path(), folder)).string(), entry.path(), {}});
  }
}

/// Adds a log and its continuations: log.lcmlog, log.lcmlog.01, ...
void addRecording(const fs::path& log, const std::string& name, std::vector<HostFile>& files) {
  const std::size_t first = log.filename().string().size();
  for (const fs::path& part : logSeries(log)) {
    files.push_back({name + part.filename().string().substr(first), part, {}});
  }
}

/// Adds only the files that DDS Security needs, because the folder may also hold the private key of
/// the certificate authority. requireCertificates() has verified that they are files of this
/// folder; the gateway reports a file that is missing.
void addCertificates(const fs::path& folder, const std::string& name,
                     std::vector<HostFile>& files) {
  for (const std::string_view file : kSecurityFiles) {
    if (!fs::exists(folder / file)) continue;
    files.push_back({(fs::path(name) / file).string(), folder / file, {}});
  }
}

}  // namespace

std::vector<HostFile> filesFor(const Experiment& e, const fs::path& directory) {
  std::vector<HostFile> files;
  addFolder(directory / files::kImages, files::kImages, files);
  addFolder(directory / files::kCalibration, files::kCalibration, files);
  std::set<std::string> logs;
  for (const RobotSpec& robot : e.robots) {
    if (robot.log.empty() || !logs.insert(robot.log).second) continue;
    addRecording(directory / robot.log, recordingName(e, robot.log), files);
  }
  // Folders that no gateway reads are not checked, and stay here.
  if (isLinkedByDds(e) && !e.link.security.empty()) {
    addCertificates(directory / e.link.security, kLinkSecurity, files);
  }
  if (e.gateway.ros && !e.gateway.security.empty()) {
    addCertificates(directory / e.gateway.security, kGatewaySecurity, files);
  }
  if (!e.gateway.mapping.empty()) files.push_back({kMapping, directory / e.gateway.mapping, {}});
  if (!e.gateway.configuration.empty()) {
    files.push_back({kDdsConfigurationElsewhere, directory / e.gateway.configuration, {}});
  }
  return files;
}

Experiment experimentElsewhere(Experiment e) {
  const Experiment here = e;
  for (RobotSpec& robot : e.robots) {
    if (!robot.log.empty()) robot.log = recordingName(here, robot.log);
  }
  if (!e.link.security.empty()) e.link.security = kLinkSecurity;
  if (!e.gateway.security.empty()) e.gateway.security = kGatewaySecurity;
  if (!e.gateway.mapping.empty()) e.gateway.mapping = kMapping;
  if (!e.gateway.configuration.empty()) e.gateway.configuration = kDdsConfigurationElsewhere;
  return e;
}

bool joinsByGateways(const Experiment& experiment, const std::vector<std::string>& hosts) {
  return !hosts.empty() && experiment.link.join == JoinBy::kDds;
}

}  // namespace lab::runner
