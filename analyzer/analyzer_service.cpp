#include "analyzer/analyzer_service.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "analyzer/service/analysis_message.hpp"
#include "analyzer/service/collective_message.hpp"
#include "common/bus/channels.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

// Slots per second. Messages are spread over them so that no listener's queue overflows: at most
// eight per slot with 250 robots of four programs (burst budget in lcmtypes/README.md).
constexpr int kSlots = 125;

}  // namespace

AnalyzerService::AnalyzerService(const ServiceContext& context, ResultReaders readers)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      feed_(context.experiment),
      crowd_(context.experiment),
      schedule_(context.experiment.analysis.results_every, readers) {
  node_.subscribe<tracked_frame_t>(channels::kTrackedFrame,
                                   [this](const tracked_frame_t& frame) { take(frame); });
  node_.subscribe<robot_status_t>(channels::kRobotStatus, [this](const robot_status_t& status) {
    feed_.take(status);
    crowd_.take(status);
    // Once, because the text of every refused state would be the same.
    if (feed_.refused() > 0 && !std::exchange(refused_state_noted_, true)) {
      node_.noteError(feed_.refusal());
    }
  });
  node_.subscribe<robot_command_t>(channels::kRobotCommand,
                                   [this](const robot_command_t& command) { feed_.take(command); });
  node_.subscribe<light_status_t>(channels::kLightStatus,
                                  [this](const light_status_t& status) { feed_.take(status); });
  loop_.every(units::kSecond_us / kSlots, loop_.now(), [this] { publishDue(); });
  loop_.soon([this] { node_.ready(); });
}

void AnalyzerService::take(const tracked_frame_t& frame) {
  if (shedding_.takesFrame(node_.backlog())) {
    feed_.take(frame);
    crowd_.take(frame);
  }
  if (shedding_.leftOut() == 0) return;
  stream_count_t row{};
  row.channel = channels::kTrackedFrame;
  row.sender = "left out of the live results: overload";
  row.received = shedding_.frames() - shedding_.leftOut();
  row.lost = shedding_.leftOut();
  node_.reportStreams({row});
  if (shedding_.hasLeftOutMore()) noteOverload();
}

/// One text with everything, and only the newest in a heartbeat.
void AnalyzerService::noteOverload() {
  const std::string pace =
      shedding_.longest() < 2 ? "" : fmt::format(" every {} s only,", shedding_.longest());
  const std::string samples = shedding_.leftOut() == 0
                                  ? "from all samples"
                                  : fmt::format("from all but {} of {} camera frames",
                                                shedding_.leftOut(), shedding_.frames());
  node_.noteError(
      fmt::format("overloaded: results are computed{} {}; the report is computed from the "
                  "log and is complete",
                  pace, samples),
      "overload");
}

void AnalyzerService::beginRound() {
  begin_utime_ = loop_.now();
  alive_utime_ = begin_utime_;
  intended_us_ = schedule_.interval();
  schedule_.computed(begin_utime_);
  feed_.simulateReferences();
  round_ = feed_.results(Depth::kLive, [this] { keepAlive(); });
  if (shedding_.computed(begin_utime_, loop_.now(), intended_us_)) noteOverload();
  round_utime_ = feed_.lastFrameUtime();
  crowd_round_ = collectiveMessages(crowd_);
  published_ = 0;
}

/// The loop cannot send the heartbeat meanwhile.
void AnalyzerService::keepAlive() {
  const std::int64_t now = loop_.now();
  if (now - alive_utime_ < units::kSecond_us) return;
  alive_utime_ = now;
  if (shedding_.computed(begin_utime_, now, intended_us_)) noteOverload();
  node_.ready();
}

void AnalyzerService::publishDue() {
  if (slot_ == 0) {
    const std::int64_t now = loop_.now();
    if (!schedule_.isDue(now) || !shedding_.isDue(now, node_.backlog())) return;
    beginRound();
  }
  ++slot_;
  const std::size_t all = crowd_round_.size() + round_.size();
  const std::size_t due = all * static_cast<std::size_t>(slot_) / kSlots;
  for (; published_ < due; ++published_) {
    if (published_ < crowd_round_.size()) {
      collective_t& crowd = crowd_round_[published_];
      if (crowd.program.hash != 0) crowd.program.name = programName(experiment_, crowd.program);
      node_.publish(channels::kCollective, crowd);
      continue;
    }
    const FeedResult& result = round_[published_ - crowd_round_.size()];
    analysis_t message = toMessage(result, programName(experiment_, result.program));
    message.utime = round_utime_;
    node_.publish(channels::kAnalysis, message);
  }
  slot_ %= kSlots;
}

ServiceDescription serviceDescription(ResultReaders readers) {
  ServiceDescription description;
  description.name = "analyzer";
  description.summary = "Measures while the lab runs whether the motion is the programmed one";
  description.needs_experiment = false;
  description.make = [readers](const ServiceContext& context) {
    return std::make_unique<AnalyzerService>(context, readers);
  };
  return description;
}

}  // namespace lab::analysis
