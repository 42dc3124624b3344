#include <fmt/format.h>

#include <cmath>

#include "analyzer/report/html/html_sections.hpp"
#include "common/text/format.hpp"

namespace lab::report::html {

std::string links(const RunRecord& record) {
  if (record.links.empty()) return {};
  const auto milliseconds = [](double seconds) {
    return std::isfinite(seconds) ? fmt::format("{:.2f}", seconds * 1e3) : std::string("–");
  };
  Table table({"host", "other host", ">messages", ">lost", ">came twice", ">too late", ">not taken",
               ">interruptions", ">its clock (ms)", ">round trip (ms)", ""});
  for (const LinkRecord& link : record.links) {
    table.row({escapeHtml(link.host), escapeHtml(link.peer), groupedText(link.received),
               groupedText(link.lost), groupedText(link.repeated), groupedText(link.stale),
               groupedText(link.timeouts), std::to_string(link.interruptions),
               milliseconds(link.lowest_offset) + " to " + milliseconds(link.highest_offset),
               milliseconds(link.round_trip), escapeHtml(link.trouble)});
  }
  return "<h2>Between hosts</h2>\n" + table.text() +
         "<p class=\"soft\">Of the messages that the other host sent here: came twice ones were "
         "dropped, as were commands that came too late. Not taken: what DDS could not send in "
         "time, "
         "to any host. Its clock: ahead of this host’s, over the run.</p>\n";
}

}  // namespace lab::report::html
