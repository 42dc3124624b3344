#include "dds/domain.hpp"

#include <dds/ddsrt/log.h>

#include <algorithm>
#include <mutex>
#include <vector>

#include "dds/error.hpp"

namespace lab::dds {
namespace {

constexpr std::size_t kMostComplaints = 100;

/// Cyclone logs from threads of its own, and for the whole process.
struct Complaints {
  std::mutex mutex;
  std::vector<std::string> lines;
};

Complaints& complaints() {
  static Complaints all;
  return all;
}

void hear(void* /*argument*/, const dds_log_data_t* data) {
  std::string text(data->message, data->size);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  auto& [mutex, lines] = complaints();
  const std::lock_guard lock(mutex);
  if (lines.size() < kMostComplaints && std::ranges::find(lines, text) == lines.end()) {
    lines.push_back(std::move(text));
  }
}

}  // namespace

Domain::Domain(int id, const std::string& configuration, const std::string& where) : id_(id) {
  static_cast<void>(takeComplaints());
  dds_set_log_sink(hear, nullptr);
  const auto fail = [&](const char* what, dds_return_t code) {
    const std::string said = takeComplaints();
    throw DdsError(where + ": " + what + " (DDS domain " + std::to_string(id) + "): " +
                   (said.empty() ? dds_strretcode(-code) : said));
  };
  const auto number = static_cast<dds_domainid_t>(id);
  const dds_entity_t domain = dds_create_domain(number, configuration.c_str());
  if (domain < 0) fail("Cyclone DDS refuses the configuration", domain);
  domain_ = Entity(domain);
  const dds_entity_t participant = dds_create_participant(number, nullptr, nullptr);
  if (participant < 0) fail("no participant could be made", participant);
  participant_ = Entity(participant);
}

std::string takeComplaints() {
  auto& [mutex, lines] = complaints();
  const std::lock_guard lock(mutex);
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  lines.clear();
  return text;
}

}  // namespace lab::dds
