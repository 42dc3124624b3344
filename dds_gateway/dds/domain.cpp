#include "dds_gateway/dds/domain.hpp"

#include <dds/ddsrt/log.h>

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <vector>

#include "dds_gateway/dds/error.hpp"

namespace lab::dds {
namespace {

constexpr std::size_t kMaxWarnings = 100;

/// Cyclone's warnings and errors. It logs from its own threads, for the whole process.
struct CycloneWarnings {
  std::mutex mutex;
  std::vector<std::string> lines;
  std::int64_t malformed = 0;
};

CycloneWarnings& cycloneWarnings() {
  static CycloneWarnings& all =
      *new CycloneWarnings;  // never deleted: Cyclone's threads may run until the process ends
  return all;
}

/// If the text is about received data, removes its numbers, so that a flood gives one warning.
/// @return whether it is
bool withoutDetails(std::string& text) {
  if (text.starts_with("malformed packet")) {
    text.erase(std::min(text.size(), text.find(" state")));
    return true;
  }
  const std::size_t number = text.find(" #");
  const std::size_t what = text.find(": deserialization");
  if (number == std::string::npos || what == std::string::npos || what < number) return false;
  text.erase(number, what - number);
  return true;
}

void onLog(void* /*argument*/, const dds_log_data_t* data) {
  std::string text(data->message, data->size);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  auto& [mutex, lines, malformed] = cycloneWarnings();
  const std::lock_guard lock(mutex);
  if (withoutDetails(text)) ++malformed;
  if (lines.size() < kMaxWarnings && std::ranges::find(lines, text) == lines.end()) {
    lines.push_back(std::move(text));
  }
}

}  // namespace

Domain::Domain(int id, const std::string& configuration, const std::string& where) : id_(id) {
  // Cyclone silently accepts half a document, and takes any other text for the name of a file. In
  // both cases it would use its defaults, which publish on every network.
  if (configuration.find_first_not_of(" \t\r\n") != configuration.find('<') ||
      configuration.find("</CycloneDDS>") == std::string::npos) {
    throw DdsError(where + ": found \"" + configuration.substr(0, 40) +
                   "\", expected an XML document <CycloneDDS> ... </CycloneDDS>");
  }
  static_cast<void>(takeWarnings());
  dds_set_log_sink(onLog, nullptr);
  const auto fail = [&](const char* what, dds_return_t code) {
    const std::string warnings = takeWarnings();
    throw DdsError(where + ": " + what + " (DDS domain " + std::to_string(id) +
                   "): " + (warnings.empty() ? dds_strretcode(-code) : warnings));
  };
  const auto number = static_cast<dds_domainid_t>(id);
  const dds_entity_t domain = dds_create_domain(number, configuration.c_str());
  if (domain < 0) fail("Cyclone DDS refuses the configuration", domain);
  domain_ = Entity(domain);
  const dds_entity_t participant = dds_create_participant(number, nullptr, nullptr);
  if (participant < 0) fail("no participant could be made", participant);
  participant_ = Entity(participant);
}

std::string takeWarnings() {
  auto& [mutex, lines, malformed] = cycloneWarnings();
  const std::lock_guard lock(mutex);
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  lines.clear();
  return text;
}

std::int64_t malformedReceived() {
  const std::lock_guard lock(cycloneWarnings().mutex);
  return cycloneWarnings().malformed;
}

}  // namespace lab::dds
