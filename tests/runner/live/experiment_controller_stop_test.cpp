// stop_when in the controller: the run ends by a result of the analyzer or by its duration.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <lab/analysis_t.hpp>
#include <lab/collective_t.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/math/units.hpp"
#include "common/service/node.hpp"
#include "runner/live/experiment_controller.hpp"
#include "tests/support/experiment_samples.hpp"

namespace lab::runner::controller_stop_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::int64_t kSecond_us = 1'000'000;

/// Added to the small experiment.
constexpr const char* kStopWhen = R"([[stop_when]]
estimate = "D_r"
program = "abp"
relative_error_percent = 10
)";

constexpr const char* kStopByCrowd = R"([[stop_when]]
observable = "largest_cluster"
relative_error_percent = 10
)";

/// The pooled D_r of the experiment's program.
analysis_t estimateOf(const Experiment& experiment, double value, double sigma) {
  analysis_t message{};
  message.robot_id = analysis_t::POOL;
  message.program = toId(experiment.programs.at("abp"));
  message.estimates.resize(1);
  message.num_estimates = 1;
  message.estimates[0].name = "D_r";
  message.estimates[0].value = value;
  message.estimates[0].sigma = sigma;
  return message;
}

collective_t crowdOf(double mean, double sigma) {
  collective_t message{};
  message.robots = 2;
  message.observables.resize(1);
  message.num_observables = 1;
  message.observables[0].name = "largest_cluster";
  message.observables[0].unit = "1";
  message.observables[0].mean = mean;
  message.observables[0].sigma = sigma;
  return message;
}

/// A controller and an analyzer that publishes once a second.
class ExperimentControllerStop : public testing::Test {
 protected:
  struct End {
    Ending ending = Ending::kBroken;
    std::string why;
    double at = 0;  ///< [s] since begin()
  };

  /// @param stop_when added to the small experiment
  /// @param publish called every second with the seconds since begin()
  End play(const char* stop_when,
           const std::function<void(const Experiment&, Node& analyzer, double)>& publish) {
    const Experiment experiment = small(stop_when);
    VirtualLoop loop;
    MemoryBus bus([&loop] { return loop.now(); });
    loop.drainWith([&bus] { bus.deliver(); });
    Node node(bus, loop, {"lab", 0, 1});
    Node analyzer(bus, loop, {"analyzer", 0, 1});
    std::optional<End> end;
    const std::int64_t begin = loop.now();
    ExperimentController controller({node, loop, experiment, "."}, writeExperiment(experiment),
                                    [&](Ending ending, const std::string& why) {
                                      if (!end)
                                        end = End{ending, why, units::seconds(loop.now() - begin)};
                                      loop.stop();
                                    });
    loop.every(kSecond_us, begin + kSecond_us, [&] {
      publish(experiment, analyzer, units::seconds(loop.now() - begin));
      progress_ = controller.progress();
    });
    node.start();
    analyzer.start();
    controller.begin();
    loop.run();
    faults_ = controller.faults();
    return end.value_or(End{});
  }

  /// The relative error falls as 1 / sqrt(t).
  /// @param first relative error after one second
  End play(double first) {
    return play(kStopWhen, [first](const Experiment& experiment, Node& analyzer, double seconds) {
      analysis_t message = estimateOf(experiment, 0.75, 0.75 * first / std::sqrt(seconds));
      analyzer.publish(channels::kAnalysis, message);
    });
  }

  Progress progress_;  ///< the last one before the end
  std::vector<std::string> faults_;
};

TEST_F(ExperimentControllerStop, EndsTheRunWhenTheEstimateIsKnown) {
  const End end = play(0.5);  // 10 % after 25 s
  EXPECT_EQ(end.ending, Ending::kDone);
  EXPECT_NEAR(end.at, 25, 1.01);  // 0.5 / sqrt(25) may round to more than 0.1
  EXPECT_THAT(end.why,
              StartsWith("stop_when: D_r of abp is known to 10 %: relative error 0.1 after"));
  EXPECT_TRUE(progress_.at_most);
  EXPECT_THAT(progress_.stop, StartsWith("D_r of abp 10"));
  EXPECT_THAT(progress_.stop, HasSubstr("wanted 10 %"));
}

TEST_F(ExperimentControllerStop, MarksARunThatDoesNotMeetTheRule) {
  const End end = play(2);
  EXPECT_EQ(end.ending, Ending::kUnmet);
  EXPECT_GE(end.at, 60);
  EXPECT_THAT(end.why,
              StartsWith("stop_when was not reached; D_r of abp is known to 10 %: relative "
                         "error 0.2"));
  EXPECT_EQ(faults_.back(), end.why);
}

TEST_F(ExperimentControllerStop, EndsTheRunWhenTheAverageOfTheCrowdIsKnown) {
  const End end = play(kStopByCrowd, [](const Experiment&, Node& analyzer, double seconds) {
    collective_t message = crowdOf(4, seconds < 30 ? 1 : 0.2);
    analyzer.publish(channels::kCollective, message);
  });
  EXPECT_EQ(end.ending, Ending::kDone);
  EXPECT_DOUBLE_EQ(end.at, 30);
  EXPECT_THAT(end.why, StartsWith("stop_when: largest_cluster is known to 10 %"));
}

/// Its relative error would be 0.
TEST_F(ExperimentControllerStop, AnInfiniteAverageOrEstimateEndsNoRun) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double value : {kInfinity, -kInfinity}) {
    const End crowd = play(kStopByCrowd, [value](const Experiment&, Node& analyzer, double) {
      collective_t message = crowdOf(value, 1);
      analyzer.publish(channels::kCollective, message);
    });
    EXPECT_EQ(crowd.ending, Ending::kUnmet) << value;
    EXPECT_GE(crowd.at, 60);
    const End estimate =
        play(kStopWhen, [value](const Experiment& experiment, Node& analyzer, double) {
          analysis_t message = estimateOf(experiment, value, 1);
          analyzer.publish(channels::kAnalysis, message);
        });
    EXPECT_EQ(estimate.ending, Ending::kUnmet) << value;
    EXPECT_GE(estimate.at, 60);
  }
}

}  // namespace
}  // namespace lab::runner::controller_stop_test
