#include "runner/campaign/adaptive/adaptive_page.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "common/text/format.hpp"

namespace lab::runner::campaign {

std::string chosenText(const CampaignData& data) {
  return fmt::format("{} of at most {}, chosen for the {}",
                     data.survey.count(RowState::Kind::kDone),
                     countText(static_cast<std::int64_t>(data.rows.size()), "run"),
                     goalText(*data.request.adaptive));
}

std::string roundsSection(const CampaignData& data, const std::vector<AdaptiveRound>& rounds) {
  if (rounds.empty()) return {};
  const AdaptivePlan& plan = *data.request.adaptive;
  std::string html =
      "<details class=\"part\"><summary><h2>Where it measured</h2></summary>\n<table><tr>"
      "<th>round</th><th>robot time before</th><th>error before</th><th>expected after</th>"
      "<th>points</th></tr>\n";
  for (const AdaptiveRound& round : rounds) {
    html +=
        fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                    round.number, durationText(round.robot_time_s), errorText(plan, round.error),
                    errorText(plan, round.expected_error), escapeHtml(placesText(data, round)));
  }
  return html + "</table></details>\n";
}

}  // namespace lab::runner::campaign
