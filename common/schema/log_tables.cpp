#include "common/schema/log_tables.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

namespace lab::schema {
namespace fs = std::filesystem;
namespace {

/// Calls `take(number, packet)` for every message of this channel and type.
void readChannel(const std::vector<fs::path>& files, std::string_view channel, const Type& type,
                 const std::function<void(std::int64_t, const Packet&)>& take) {
  std::int64_t number = 0;
  readLog(files, [&](const Packet& packet) {
    const std::int64_t event = number++;
    if (packet.channel != channel) return;
    if (fingerprintOf(packet.data.data(), packet.data.size()) == type.hash) take(event, packet);
  });
}

}  // namespace

const LoggedChannel* LogContents::find(std::string_view channel) const {
  const LoggedChannel* found = nullptr;
  for (const LoggedChannel& logged : channels) {
    const bool wanted = logged.channel == channel && logged.type != nullptr;
    if (wanted && (found == nullptr || logged.messages > found->messages)) found = &logged;
  }
  return found;
}

LogContents logContents(const std::vector<fs::path>& files) {
  LogContents contents;
  std::map<std::pair<std::string, std::int64_t>, LoggedChannel> channels;
  contents.read = readLog(files, [&](const Packet& packet) {
    const std::int64_t hash = fingerprintOf(packet.data.data(), packet.data.size());
    const Type* type = messageSchema().findHash(hash);
    LoggedChannel& logged = channels[{std::string(packet.channel), type == nullptr ? 0 : hash}];
    if (logged.messages == 0) {
      logged.channel = packet.channel;
      logged.type = type;
      logged.first_utime = packet.received_utime;
    }
    ++logged.messages;
    logged.bytes += static_cast<std::int64_t>(packet.data.size());
    logged.last_utime = packet.received_utime;
  });
  for (auto& [key, logged] : channels) contents.channels.push_back(std::move(logged));
  std::ranges::stable_partition(contents.channels,
                                [](const LoggedChannel& logged) { return logged.type != nullptr; });
  return contents;
}

LoadedTable loadTable(const std::vector<fs::path>& files, std::string_view channel,
                      const Type& type, std::string_view path,
                      const std::optional<std::vector<std::string>>& selection) {
  LoadedTable loaded{MessageTable(type, path, selection)};
  MessageTable counted(type, path, std::vector<std::string>{});
  readChannel(files, channel, type, [&](std::int64_t event, const Packet& packet) {
    counted.take(event, packet.received_utime, packet.data);
  });
  loaded.table.reserve(counted.rows());
  readChannel(files, channel, type, [&](std::int64_t event, const Packet& packet) {
    if (!loaded.table.take(event, packet.received_utime, packet.data)) ++loaded.undecodable;
  });
  return loaded;
}

}  // namespace lab::schema
