#include "runner/campaign/campaign_data.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "common/process/version.hpp"
#include "runner/command_line/revision.hpp"

namespace lab::runner::campaign {

CodeVersion thisCode() {
  const std::string revision = sourceRevision();
  return {revision.empty() ? kVersion : fmt::format("{} ({})", kVersion, revision),
          kContractVersion};
}

CampaignData dataOf(StoredCampaign campaign) {
  CampaignData data;
  data.code = thisCode();
  data.axes = campaign.request.design().axes;
  data.rows = rowsOf(campaign.request, campaign.points, data.code);
  data.request = std::move(campaign.request);
  data.created = std::move(campaign.created);
  data.points = std::move(campaign.points);
  data.survey.rows.resize(data.rows.size());
  return data;
}

}  // namespace lab::runner::campaign
