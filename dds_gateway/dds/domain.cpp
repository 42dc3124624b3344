#include "dds_gateway/dds/domain.hpp"

#include <dds/ddsrt/log.h>

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <vector>

#include "dds_gateway/dds/error.hpp"

namespace lab::dds {
namespace {

constexpr std::size_t kMostComplaints = 100;

/// Cyclone logs from threads of its own, and for the whole process.
struct Complaints {
  std::mutex mutex;
  std::vector<std::string> lines;
  std::int64_t malformed = 0;
};

Complaints& complaints() {
  static Complaints& all = *new Complaints;  // Cyclone's threads may outlive all of ours
  return all;
}

/// Whether this is about what somebody sent; then without the numbers in it, so that a flood of
/// such is one complaint.
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

void hear(void* /*argument*/, const dds_log_data_t* data) {
  std::string text(data->message, data->size);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  auto& [mutex, lines, malformed] = complaints();
  const std::lock_guard lock(mutex);
  if (withoutDetails(text)) ++malformed;
  if (lines.size() < kMostComplaints && std::ranges::find(lines, text) == lines.end()) {
    lines.push_back(std::move(text));
  }
}

}  // namespace

Domain::Domain(int id, const std::string& configuration, const std::string& where) : id_(id) {
  // Cyclone takes half a document without a word, and anything else for the name of a file: either
  // would be its own defaults, which are heard on every network.
  if (configuration.find_first_not_of(" \t\r\n") != configuration.find('<') ||
      configuration.find("</CycloneDDS>") == std::string::npos) {
    throw DdsError(where + ": found \"" + configuration.substr(0, 40) +
                   "\", expected an XML document <CycloneDDS> ... </CycloneDDS>");
  }
  static_cast<void>(takeWarnings());
  dds_set_log_sink(hear, nullptr);
  const auto fail = [&](const char* what, dds_return_t code) {
    const std::string said = takeWarnings();
    throw DdsError(where + ": " + what + " (DDS domain " + std::to_string(id) +
                   "): " + (said.empty() ? dds_strretcode(-code) : said));
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
  auto& [mutex, lines, malformed] = complaints();
  const std::lock_guard lock(mutex);
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  lines.clear();
  return text;
}

std::int64_t malformedReceived() {
  const std::lock_guard lock(complaints().mutex);
  return complaints().malformed;
}

}  // namespace lab::dds
