#include "common/schema/log_tables.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "common/bus/logged_messages.hpp"
#include "common/schema/checked_encoding.hpp"

namespace lab::schema {
namespace fs = std::filesystem;

LogIndex::LogIndex(std::vector<fs::path> files) : files_(std::move(files)) {
  struct Found {
    LoggedChannel logged;
    std::vector<Entry> entries;
  };
  // By channel, unknown types last, and type.
  std::map<std::pair<std::string, std::int64_t>, Found> found;
  LogReader reader(files_);
  for (std::int64_t event = 0; const auto packet = reader.next(); ++event) {
    const std::int64_t hash = fingerprintOf(packet->data.data(), packet->data.size());
    const Type* type = messageSchema().findHash(hash);
    Found& of = found[{std::string(packet->channel), type == nullptr ? 0 : hash}];
    LoggedChannel& logged = of.logged;
    if (logged.messages == 0) {
      logged.channel = packet->channel;
      logged.type = type;
      logged.first_utime = packet->received_utime;
    }
    ++logged.messages;
    logged.bytes += static_cast<std::int64_t>(packet->data.size());
    logged.last_utime = packet->received_utime;
    const LogPosition& at = reader.position();
    of.entries.push_back({event, packet->received_utime, at.offset,
                          static_cast<std::uint32_t>(at.size),
                          static_cast<std::uint32_t>(at.file)});
  }
  result_ = reader.result();
  for (const bool known : {true, false}) {
    for (auto& [key, of] : found) {
      if ((of.logged.type != nullptr) != known) continue;
      channels_.push_back(std::move(of.logged));
      entries_.push_back(std::move(of.entries));
    }
  }
}

const LoggedChannel* LogIndex::find(std::string_view channel) const {
  const LoggedChannel* best = nullptr;
  for (const LoggedChannel& logged : channels_) {
    const bool wanted = logged.channel == channel && logged.type != nullptr;
    if (wanted && (best == nullptr || logged.messages > best->messages)) best = &logged;
  }
  return best;
}

void LogIndex::read(std::string_view channel, const Type& type,
                    const std::function<void(std::int64_t, const Packet&)>& take) const {
  LoggedMessages messages(files_);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].channel != channel || channels_[i].type != &type) continue;
    for (const Entry& entry : entries_[i]) {
      take(entry.event,
           {channel, messages.at({entry.file, entry.offset, entry.size}), entry.utime});
    }
  }
}

ChannelCheck checkChannel(const LogIndex& log, std::string_view channel, const Type& type) {
  ChannelCheck result;
  log.read(channel, type, [&](std::int64_t event, const Packet& packet) {
    CheckedEncoding checked = checkEncoding(packet.data);
    if (checked.problem.empty()) return;
    if (result.first.empty()) result.first = checked.problem;
    result.undecodable += checked.decoded ? 0 : 1;
    result.refused += checked.decoded && !checked.usable ? 1 : 0;
    result.removed += checked.removed;
    result.changed.emplace(event, std::move(checked.remaining));
  });
  return result;
}

LoadedTable loadTable(const LogIndex& log, std::string_view channel, const Type& type,
                      std::string_view path,
                      const std::optional<std::vector<std::string>>& selection,
                      const ChannelCheck* check) {
  LoadedTable loaded{MessageTable(type, path, selection)};
  if (check != nullptr) loaded.undecodable = check->undecodable;
  log.read(channel, type, [&](std::int64_t event, const Packet& packet) {
    Bytes data = packet.data;
    if (check != nullptr) {
      const auto changed = check->changed.find(event);
      if (changed != check->changed.end()) {
        if (changed->second.empty()) return;
        data = changed->second;
      }
    }
    if (!loaded.table.take(event, packet.received_utime, data)) ++loaded.undecodable;
  });
  return loaded;
}

}  // namespace lab::schema
