#include "runner/campaign/queue/campaign_queue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "common/bus/value_checker.hpp"
#include "common/text/format.hpp"
#include "common/text/json_text.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace {

using State = QueuedCampaign::State;

constexpr std::array<std::pair<State, const char*>, 4> kStates{{{State::kWaiting, "waiting"},
                                                                {State::kRunning, "running"},
                                                                {State::kDone, "done"},
                                                                {State::kFailed, "failed"}}};

QueuedCampaign campaignOf(const nlohmann::json& json) {
  QueuedCampaign campaign;
  constexpr std::int64_t kMostNumber = 1'000'000'000;
  campaign.number = wholeNumber<std::int64_t>(json.at("number"), 0, kMostNumber);
  campaign.arguments = json.at("arguments").get<std::vector<std::string>>();
  campaign.folder = json.at("folder").get<std::string>();
  const auto state = json.at("state").get<std::string>();
  const auto* const known =
      std::ranges::find(kStates, state, [](const auto& pair) { return std::string(pair.second); });
  if (known == kStates.end()) throw std::runtime_error("state: found " + state);
  campaign.state = known->first;
  const auto timeOf = [&json](const char* key) {
    return wholeNumber<std::int64_t>(json.at(key), 0, ValueChecker::kLatestUtime);
  };
  campaign.begin_us = timeOf("begin_us");
  campaign.end_us = timeOf("end_us");
  campaign.exit_code = wholeNumber(json.at("exit_code"), -1, 255);
  return campaign;
}

}  // namespace

const char* nameOf(State state) {
  return std::ranges::find(kStates, state, [](const auto& pair) { return pair.first; })->second;
}

std::vector<QueuedCampaign> readQueue(std::string_view text, const std::string& name) {
  std::vector<QueuedCampaign> queue;
  if (text.empty()) return queue;
  try {
    const auto read = parseJsonText(text);
    if (!read.is_array()) throw std::runtime_error("expected a list");
    for (const nlohmann::json& campaign : read) queue.push_back(campaignOf(campaign));
  } catch (const std::exception& error) {
    throw UserError(fmt::format(
        "{}: found a file that lab queue did not write or that is damaged ({}); remove it, and add "
        "the campaigns again",
        name, error.what()));
  }
  return queue;
}

std::string queueText(const std::vector<QueuedCampaign>& queue) {
  auto json = nlohmann::ordered_json::array();
  for (const QueuedCampaign& campaign : queue) {
    json.push_back({{"number", campaign.number},
                    {"arguments", campaign.arguments},
                    {"folder", campaign.folder},
                    {"state", nameOf(campaign.state)},
                    {"begin_us", campaign.begin_us},
                    {"end_us", campaign.end_us},
                    {"exit_code", campaign.exit_code}});
  }
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::optional<std::size_t> nextOf(const std::vector<QueuedCampaign>& queue) {
  for (const State state : {State::kRunning, State::kWaiting}) {
    const auto found = std::ranges::find(queue, state, &QueuedCampaign::state);
    if (found != queue.end()) return static_cast<std::size_t>(found - queue.begin());
  }
  return {};
}

std::string lineOf(const QueuedCampaign& campaign) {
  std::string state = nameOf(campaign.state);
  if (campaign.end_us != 0) {
    state += " in " + durationText(static_cast<double>(campaign.end_us - campaign.begin_us) * 1e-6);
  }
  if (campaign.state == State::kFailed) state += fmt::format(", exit code {}", campaign.exit_code);
  return fmt::format("{:>3}  lab sweep {}  ({})", campaign.number,
                     fmt::join(campaign.arguments, " "), state);
}

}  // namespace lab::runner::campaign
