#include "runner/export/table_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "common/bus/bus_error.hpp"
#include "common/schema/array_groups.hpp"
#include "common/schema/message_table.hpp"
#include "common/text/printable.hpp"

namespace lab::runner {
namespace {

bool isTableName(std::string_view channel) {
  constexpr std::string_view kAllowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
  return !channel.empty() && channel.size() <= kLongestChannelName && channel.front() != '.' &&
         channel.find_first_not_of(kAllowed) == std::string_view::npos;
}

}  // namespace

void LeftOut::count(std::string_view channel) {
  const auto refused = channels.find(channel);
  ++(refused == channels.end() ? messages : refused->second);
}

std::string channelsText(const LeftOut& left_out) {
  constexpr std::size_t kMostNamed = 5;
  std::string names;
  std::size_t named = 0;
  std::int64_t messages = 0;
  for (const auto& [channel, count] : left_out.channels) {
    messages += count;
    if (++named > kMostNamed) continue;
    const bool whole = channel.size() <= kLongestChannelName;
    names += fmt::format("{}\"{}{}\"", named == 1 ? "" : ", ",
                         printable(channel.substr(0, kLongestChannelName)), whole ? "" : "...");
  }
  if (named == 0) return {};
  if (named > kMostNamed) names += fmt::format(" and {} more", named - kMostNamed);
  return fmt::format(
      "{} message{} on {} channel{} left out: found the name{} {}, expected 1 to 63 letters, "
      "digits and _ . -, no dot first, and no name of another table; lab export --mcap has them",
      messages, messages == 1 ? "" : "s", named, named == 1 ? "" : "s", named == 1 ? "" : "s",
      names);
}

TableChannels tableChannels(const schema::LogIndex& log, std::set<std::string> taken) {
  TableChannels result;
  for (const schema::LoggedChannel& logged : log.channels()) {
    // A channel has one type; messages of another type on it are a stranger's.
    if (logged.type == nullptr || log.find(logged.channel)->type != logged.type) continue;
    std::vector<std::string> titles;
    for (const std::string& path : schema::tablePaths(*logged.type)) {
      titles.push_back(tableTitle(logged.channel, path));
    }
    const auto is_taken = [&](const std::string& title) { return taken.contains(title); };
    if (!isTableName(logged.channel) || std::ranges::any_of(titles, is_taken)) {
      result.left_out.channels.emplace(logged.channel, 0);
      continue;
    }
    taken.insert(titles.begin(), titles.end());
    result.kept.push_back(logged);
  }
  return result;
}

std::string tableTitle(std::string_view channel, std::string_view path) {
  return fmt::format("{}{}{}", channel, path.empty() ? "" : ".", path);
}

}  // namespace lab::runner
