#include "runner/hosts/host_contract.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "common/bus/fingerprints.hpp"
#include "common/bus/value_checker.hpp"
#include "common/math/units.hpp"
#include "common/process/installation.hpp"
#include "common/process/version.hpp"
#include "common/text/fnv1a.hpp"
#include "common/text/json_text.hpp"
#include "runner/command_line/revision.hpp"
#include "runner/doctor/machine.hpp"

namespace lab::runner {
namespace {

std::string versionText(const HostHello& hello) {
  return hello.version + (hello.revision.empty() ? "" : " (" + hello.revision + ")");
}

std::string lastLine(const std::string& text) {
  std::istringstream lines(text);
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    while (!line.empty() && line.back() == '\r') line.pop_back();
    if (!line.empty()) last = line;
  }
  return last;
}

bool contains(const std::string& text, const char* words) {
  return text.find(words) != std::string::npos;
}

}  // namespace

HostHello ownHello() {
  HostHello hello;
  hello.version = kVersion;
  hello.contract_version = kContractVersion;
  hello.fingerprints = fmt::format("{:016x}", fnv1a(fingerprintList()));
  hello.revision = sourceRevision();
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  hello.host = name.data();
  const char* connection = std::getenv("SSH_CONNECTION");
  hello.ssh_connection = connection == nullptr ? "" : connection;
  hello.multicast = multicastInterface().value_or("");
  hello.utime = std::chrono::duration_cast<std::chrono::microseconds>(
                    std::chrono::system_clock::now().time_since_epoch())
                    .count();
  return hello;
}

nlohmann::json toJson(const HostHello& hello) {
  return {{"say", "hello"},
          {"version", hello.version},
          {"contract_version", hello.contract_version},
          {"fingerprints", hello.fingerprints},
          {"revision", hello.revision},
          {"host", hello.host},
          {"ssh_connection", hello.ssh_connection},
          {"multicast", hello.multicast},
          {"utime", hello.utime}};
}

std::optional<HostHello> helloFrom(const nlohmann::json& json) {
  try {
    if (json.value("say", "") != "hello") return std::nullopt;
    const auto whole = [&json]<class Number>(const char* key, Number most) {
      return json.contains(key) ? wholeNumber<Number>(json.at(key), 0, most) : 0;
    };
    return HostHello{json.at("version"),
                     whole("contract_version", std::numeric_limits<int>::max()),
                     json.value("fingerprints", ""),
                     json.value("revision", ""),
                     json.value("host", ""),
                     json.value("ssh_connection", ""),
                     json.value("multicast", ""),
                     whole("utime", ValueChecker::kLatestUtime)};
  } catch (const std::exception&) {  // of nlohmann::json, or of wholeNumber()
    return std::nullopt;
  }
}

std::string refusal(const HostSpec& host, const HostHello& here, const HostHello& there) {
  std::string difference;
  if (there.version != here.version) {
    difference = "another version";
  } else if (there.contract_version != here.contract_version ||
             there.fingerprints != here.fingerprints) {
    difference = "other message types";
  } else if (!there.revision.empty() && !here.revision.empty() && there.revision != here.revision) {
    difference = "another state of the source";
  }
  if (difference.empty()) return {};
  return fmt::format(
      "host {}: found {} of the lab, {} there and {} here, expected the same on both; update "
      "(ssh {}, then {}), or name the folder of the right programs there: "
      "hosts.{}.programs",
      host.name, difference, versionText(there), versionText(here), host.ssh,
      installation().installHint("lab", "git pull and ./lab build in its folder"), host.name);
}

std::string clockRefusal(const HostSpec& host, const ClockOffset& clock, double allowed) {
  if (std::isnan(clock.offset)) {
    return fmt::format(
        "host {}: found no possible time in its answers, expected microseconds since 1970, and "
        "answers within a minute; set the clocks of both hosts (docs/hosts.md) and start again",
        host.name);
  }
  if (std::abs(clock.offset) - clock.error <= allowed) return {};
  return fmt::format(
      "host {}: its clock is {:.1f} ms {} of this one (known to {:.1f} ms), allowed {:g} ms "
      "(link.max_clock_offset_ms); on both: sudo apt-get install chrony, wait a minute, chronyc "
      "tracking (docs/hosts.md)",
      host.name, std::abs(clock.offset) * 1e3, clock.offset > 0 ? "ahead" : "behind",
      clock.error * 1e3, allowed * 1e3);
}

std::optional<SshEnds> endsOf(const std::string& ssh_connection) {
  std::istringstream words(ssh_connection);
  SshEnds ends;
  std::string port;
  if (words >> ends.here >> port >> ends.there) return ends;
  return std::nullopt;
}

std::string sshTrouble(const HostSpec& host, const std::string& said, const std::string& ending) {
  struct KnownError {
    const char* words;
    std::string explanation;
  };
  const std::string programs = installation().installHint(
      "lab", "build it there (./lab build in its folder) and set hosts." + host.name +
                 ".programs = \"FOLDER/build/release/bin\"");
  const std::vector<KnownError> known_errors = {
      {"Could not resolve hostname", "no machine of that name is known: set hosts." + host.name +
                                         ".ssh = \"user@address\", or name it in ~/.ssh/config"},
      {"IDENTIFICATION HAS CHANGED",
       "its host key has changed; if the machine was reinstalled: ssh-keygen -R " +
           host.ssh.substr(host.ssh.find('@') + 1)},
      {"Host key verification failed",
       "its key is not known yet: type ssh " + host.ssh + " once and accept the key"},
      {"Permission denied",
       "it does not let this user in without a password: ssh-copy-id " + host.ssh},
      {"Connection refused",
       "no ssh server answers there: sudo apt-get install openssh-server (there)"},
      {"timed out", "it does not answer: is it switched on and connected?"},
      {"No route to host", "it does not answer: is it switched on and connected?"},
      {"Network is unreachable", "this machine has no route to it: is the cable connected?"},
      {"no such command: host-agent", "the lab there is an older version: git pull there"},
      {"host-agent", "the lab there is an older version or not installed: " + programs},
      {"not found", "the program lab was not found: " + programs},
      {"No such file", "the program lab was not found: " + programs},
  };
  const std::string last = lastLine(said);
  const std::string head = "host " + host.name + " (ssh " + host.ssh + "): ";
  const std::string tail = last.empty() ? "" : " [" + last + "]";
  if (ending == "exit code 126")
    return head + "the lab there cannot be executed: " + programs + tail;
  for (const KnownError& known : known_errors) {
    if (contains(said, known.words)) return head + known.explanation + tail;
  }
  if (ending == "exit code 127") return head + "the program lab was not found: " + programs + tail;
  return head + (last.empty() ? "ssh ended (" + ending + ")" : last);
}

std::string agentCommand(const HostSpec& host) {
  // A lab from a Debian package uses the package on the host as well.
  if (host.programs.empty()) {
    return installation().packaged ? "exec active-lab host-agent" : "exec lab host-agent";
  }
  // Quoted for the remote shell, except a leading ~, which that shell must expand.
  std::string folder = host.programs;
  std::string home;
  if (folder == "~" || folder.starts_with("~/")) {
    home = "~/";
    folder.erase(0, 2);
  }
  std::string quoted;
  for (const char c : folder) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return "exec " + home + "'" + quoted + (quoted.empty() ? "lab" : "/lab") + "' host-agent";
}

}  // namespace lab::runner
