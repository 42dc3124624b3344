// How the controller handles requests (EXPERIMENT_COMMAND) during a run.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <lab/experiment_event_t.hpp>
#include <lab/light_command_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/math/units.hpp"
#include "common/service/node.hpp"
#include "runner/live/experiment_controller.hpp"

namespace lab::runner {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr const char* kPlanned = R"(fileversion = 1
name = "requests"
duration_s = 30
program = "abp"
[[robots]]
id = 1
[programs.rtp]
model = "rtp"
v_cm_s = 5
gamma_per_s = 3
tau_t_s = 0.5
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
)";

constexpr const char* kSteps = R"([[light.steps]]
at_s = 0
label = "one"
layers = [{kind = "uniform", intensity = 0.5}]
[[light.steps]]
at_s = 10
label = "two"
layers = [{kind = "uniform", intensity = 0.6}]
)";

constexpr const char* kWaits = R"([[light.steps]]
label = "one"
until = {tumbles = 3}
hold_s = 10
layers = [{kind = "uniform", intensity = 0.5}]
[[light.steps]]
label = "two"
hold_s = 5
layers = [{kind = "uniform", intensity = 0.6}]
)";

/// Robots that tumble, and a step that waits for tumbles.
std::string tumbling() {
  std::string file = std::string(kPlanned) + kWaits;
  const std::string program = "program = \"abp\"";
  return file.replace(file.find(program), program.size(), "program = \"rtp\"");
}

/// A controller on a bus with an obedient robot and a sender of requests.
class ExperimentControllerRequests : public testing::Test {
 protected:
  ExperimentControllerRequests() {
    loop_.drainWith([this] { bus_.deliver(); });
    page_.subscribe<experiment_status_t>(channels::kExperimentStatus, [this](const auto& status) {
      statuses_.push_back(status);
      phases_[status.phase] = true;
    });
    page_.subscribe<experiment_event_t>(channels::kExperimentEvent, [this](const auto& event) {
      const bool is_new = marks_.empty() || marks_.back() != event.text;
      if (event.kind == experiment_event_t::MARK && is_new) marks_.push_back(event.text);
      if (event.kind != experiment_event_t::STEP) return;
      begins_[event.label] = since(event.commanded_utime);
    });
    page_.subscribe<light_command_t>(channels::kLightCommand,
                                     [this](const auto& command) { light_ = command; });
    page_.subscribe<robot_command_t>(channels::kRobotCommand, [this](const auto& command) {
      if (!robot_answers_) return;
      robot_status_t status{};
      status.robots.resize(1);
      status.num_robots = 1;
      status.robots[0].robot_id = 1;
      status.robots[0].utime = loop_.now();
      status.robots[0].command_seq = command.seq;
      status.robots[0].command_instance = command.instance;
      status.robots[0].tumble_count = tumbles_;
      robot_.publish(channels::kRobotStatus, status);
    });
  }

  void start(const std::string& file) {
    experiment_ = parseExperiment(file, "test");
    controller_.emplace(ServiceContext{node_, loop_, experiment_, "runs/requests-01"},
                        writeExperiment(experiment_),
                        [this](Ending ending, const std::string& why) {
                          if (!ending_) ended_at_ = since(loop_.now());
                          ending_ = ending;
                          why_ = why;
                          loop_.stop();
                        });
    node_.start();
    begin_ = loop_.now();
    controller_->begin();
    script_ = begin_;
    loop_.runUntil(begin_ + 1'000'000);
    ASSERT_TRUE(controller_->inScript());
  }

  /// Runs until `s` seconds after the begin of the script.
  void goTo(double s) { loop_.runUntil(script_ + units::microseconds(s)); }

  void request(std::int8_t action, const std::string& text = {}, int copies = 1) {
    experiment_command_t command{};
    command.action = action;
    command.text = text;
    command.seq = ++seq_;
    for (int i = 0; i < copies; ++i) page_.publishCommand(channels::kExperimentCommand, command);
    bus_.deliver();
  }

  void announceMarks() {
    controller_->announceMarks([this](const std::string& label, const std::string& what) {
      labels_.push_back(label);
      announced_.push_back(what);
    });
  }

  [[nodiscard]] double since(std::int64_t utime) const { return units::seconds(utime - script_); }
  [[nodiscard]] const experiment_status_t& status() const { return statuses_.back(); }

  VirtualLoop loop_;
  MemoryBus bus_{[this] { return loop_.now(); }};
  Node node_{bus_, loop_, {"lab", 0, 1}};
  Node page_{bus_, loop_, {"page", 0, 5}};
  Node robot_{bus_, loop_, {"sim_svc", 0, 1}};
  Experiment experiment_;
  std::optional<ExperimentController> controller_;
  std::int64_t begin_ = 0;
  std::int64_t script_ = 0;
  std::int64_t seq_ = 0;
  std::int32_t tumbles_ = 0;
  bool robot_answers_ = true;

  std::vector<experiment_status_t> statuses_;
  std::map<std::int8_t, bool> phases_;
  std::vector<std::string> marks_;
  std::vector<std::string> announced_;
  std::vector<std::string> labels_;
  std::map<std::string, double> begins_;
  light_command_t light_{};
  std::optional<Ending> ending_;
  double ended_at_ = 0;
  std::string why_;
};

TEST_F(ExperimentControllerRequests, PublishesTheStateOfTheRun) {
  start(std::string(kPlanned) + kSteps);
  goTo(4);
  EXPECT_EQ(status().sender, "lab");
  EXPECT_EQ(status().run, "") << "in virtual time";
  EXPECT_EQ(status().phase, experiment_status_t::SCRIPT);
  EXPECT_NEAR(status().elapsed, 4, 0.5);
  EXPECT_DOUBLE_EQ(status().left, 30 - status().elapsed);
  EXPECT_EQ(status().at_most, 0);
  EXPECT_EQ(status().rate, 1);
  EXPECT_EQ(status().step, 0);
  EXPECT_EQ(status().label, "one");
  EXPECT_DOUBLE_EQ(status().step_left, 10 - status().elapsed);
  EXPECT_EQ(status().stop, "");
  EXPECT_EQ(status().commander, "");

  statuses_.clear();
  goTo(9.99);
  EXPECT_EQ(statuses_.size(), 11U) << "2 Hz";
  statuses_.clear();
  goTo(10.2);
  EXPECT_EQ(status().step, 1);
  EXPECT_EQ(status().label, "two");
  EXPECT_TRUE(std::isnan(status().step_left)) << "nothing follows";
  goTo(40);
  controller_->conclude("over");
  bus_.deliver();
  EXPECT_EQ(status().phase, experiment_status_t::ENDED);
  EXPECT_EQ(status().left, 0);
}

TEST_F(ExperimentControllerRequests, APauseShiftsTheRestOfTheScript) {
  start(std::string(kPlanned) + kSteps);
  goTo(4);
  request(experiment_command_t::PAUSE, "", 3);
  EXPECT_EQ(status().phase, experiment_status_t::PAUSED);
  EXPECT_EQ(status().command_seq, 1);
  EXPECT_EQ(status().commander, "page");
  EXPECT_EQ(status().command_instance, 5);
  EXPECT_EQ(status().refusal, "");
  EXPECT_TRUE(controller_->progress().paused);
  const std::int64_t light = light_.seq;

  goTo(4 + 30);  // after the planned end of the step and of the run
  EXPECT_EQ(status().phase, experiment_status_t::PAUSED);
  EXPECT_DOUBLE_EQ(status().elapsed, 4);
  EXPECT_DOUBLE_EQ(status().left, 26);
  EXPECT_DOUBLE_EQ(status().step_left, 6);
  EXPECT_EQ(light_.seq, light) << "the light stays";
  EXPECT_FALSE(ending_);
  goTo(4 + 33.2);
  request(experiment_command_t::RESUME);
  EXPECT_EQ(status().phase, experiment_status_t::SCRIPT);

  goTo(100);
  EXPECT_EQ(ending_, Ending::kDone);
  controller_->conclude(why_);
  bus_.deliver();
  EXPECT_DOUBLE_EQ(begins_.at("one"), 0);
  EXPECT_DOUBLE_EQ(begins_.at("two"), 10 + 33.2);
  EXPECT_DOUBLE_EQ(ended_at_, 30 + 33.2);
  EXPECT_THAT(marks_, ElementsAre("script paused by page", "script resumed by page after 33.2 s"));
  EXPECT_THAT(controller_->faults(), IsEmpty());
}

TEST_F(ExperimentControllerRequests, PausesAddUp) {
  start(std::string(kPlanned) + kSteps);
  for (const double at : {2.0, 5.0, 9.0}) {
    goTo(at);
    request(experiment_command_t::PAUSE);
    goTo(at + 0.25);
    request(experiment_command_t::RESUME);
  }
  goTo(100);
  controller_->conclude(why_);
  bus_.deliver();
  EXPECT_DOUBLE_EQ(begins_.at("two"), 10.75);
  EXPECT_DOUBLE_EQ(ended_at_, 30.75);
}

TEST_F(ExperimentControllerRequests, APauseExtendsTheTimeoutOfACondition) {
  start(tumbling());
  goTo(6);
  request(experiment_command_t::PAUSE);
  goTo(16);
  request(experiment_command_t::RESUME);
  goTo(19.9);
  EXPECT_EQ(status().step, 0);
  goTo(20.1);
  EXPECT_EQ(status().step, 1);
  EXPECT_THAT(controller_->faults(), ElementsAre(HasSubstr("after 10 s its condition")));
}

TEST_F(ExperimentControllerRequests, AConditionCanBeMetDuringAPause) {
  start(tumbling());
  goTo(2);
  request(experiment_command_t::PAUSE);
  tumbles_ = 3;
  goTo(5);
  EXPECT_EQ(status().step, 0);
  request(experiment_command_t::RESUME);
  EXPECT_EQ(status().step, 1);
  goTo(100);
  controller_->conclude(why_);
  bus_.deliver();
  EXPECT_DOUBLE_EQ(begins_.at("two"), 5);
  EXPECT_DOUBLE_EQ(ended_at_, 10);
  EXPECT_THAT(controller_->faults(), IsEmpty());
}

TEST_F(ExperimentControllerRequests, StopRulesApplyDuringAPause) {
  start(std::string(kPlanned) +
        "[[stop_when]]\nestimate = \"D_r\"\nprogram = \"abp\"\nrelative_error_percent = 10\n");
  EXPECT_EQ(status().at_most, 1);
  EXPECT_THAT(status().stop, HasSubstr("not known yet"));
  request(experiment_command_t::PAUSE);
  goTo(5);
  analysis_t message{};
  message.robot_id = analysis_t::POOL;
  message.program = toId(experiment_.programs.at("abp"));
  message.estimates.resize(1);
  message.num_estimates = 1;
  message.estimates[0].name = "D_r";
  message.estimates[0].value = 1;
  message.estimates[0].sigma = 0.05;
  page_.publish(channels::kAnalysis, message);
  bus_.deliver();
  EXPECT_EQ(ending_, Ending::kDone);
  EXPECT_DOUBLE_EQ(ended_at_, 5);
}

TEST_F(ExperimentControllerRequests, RefusesInvalidRequestsWithAReason) {
  start(std::string(kPlanned) + kSteps);
  request(experiment_command_t::RESUME);
  EXPECT_THAT(status().refusal, HasSubstr("is not paused"));
  request(experiment_command_t::PAUSE);
  EXPECT_EQ(status().refusal, "");
  request(experiment_command_t::PAUSE);
  EXPECT_THAT(status().refusal, HasSubstr("paused already"));
  request(experiment_command_t::SEEK);
  EXPECT_THAT(status().refusal, HasSubstr("only the replay of a log"));
  request(experiment_command_t::SPEED);
  EXPECT_THAT(status().refusal, HasSubstr("only the replay of a log"));
  request(99);
  EXPECT_THAT(status().refusal, HasSubstr("unknown"));
  request(experiment_command_t::MARK);
  EXPECT_THAT(status().refusal, HasSubstr("needs a text"));
  request(experiment_command_t::MARK, "two\nlines");
  EXPECT_THAT(status().refusal, HasSubstr("control characters"));
  EXPECT_EQ(status().command_seq, 8);
  EXPECT_THAT(marks_, ElementsAre("script paused by page"));
  controller_->conclude("over");
  request(experiment_command_t::PAUSE);
  EXPECT_THAT(status().refusal, HasSubstr("over"));
}

TEST_F(ExperimentControllerRequests, ARepeatedMarkIsRecordedOnce) {
  start(std::string(kPlanned) + kSteps);
  request(experiment_command_t::MARK, "robot 4 lost a wheel, \u03B7 wrong", 5);
  EXPECT_THAT(marks_, ElementsAre("page: robot 4 lost a wheel, \u03B7 wrong"));
  EXPECT_EQ(status().refusal, "");
}

TEST_F(ExperimentControllerRequests, AnnouncesEachRequestOnceWithWhatUndoesIt) {
  start(std::string(kPlanned) + kSteps);
  announceMarks();
  robot_stop_t stop{};
  stop.reason = "from\x1b[2J the page";
  stop.seq = 7;
  for (int copy = 0; copy < 3; ++copy) page_.publishCommand(channels::kRobotStop, stop);
  bus_.deliver();
  EXPECT_THAT(announced_, ElementsAre("robots stopped by page: from [2J the page (lab stop "
                                      "--clear, or release on the page, lets them go on)"));
  EXPECT_EQ(controller_->progress().robots_stopped, 1U);
  stop.reason.clear();
  stop.clear = 1;
  stop.seq = 8;
  page_.publishCommand(channels::kRobotStop, stop);
  bus_.deliver();
  EXPECT_EQ(announced_.back(), "stop released by page");
  EXPECT_EQ(controller_->progress().robots_stopped, 0U);

  goTo(4);
  request(experiment_command_t::PAUSE, "", 3);
  EXPECT_EQ(announced_.back(),
            "script paused by page (lab resume, or resume on the page, continues it)");
  goTo(6);
  request(experiment_command_t::RESUME);
  request(experiment_command_t::MARK, "robot 4 lost a wheel");
  EXPECT_THAT(announced_, SizeIs(5));
  EXPECT_EQ(announced_[3], "script resumed by page after 2.0 s");
  EXPECT_EQ(announced_[4], "page: robot 4 lost a wheel");
  EXPECT_THAT(labels_, testing::Each("request"));
}

TEST_F(ExperimentControllerRequests, SaysOnceThatTheAnalyzerIsOverloadedAndMarksTheRecord) {
  start(std::string(kPlanned) + kSteps);
  announceMarks();
  Node analyzer(bus_, loop_, {"analyzer", 0, 1});
  analyzer.noteError("overloaded: results are computed every 8 s only");
  analyzer.start();
  goTo(4);

  const std::string said = "analyzer: overloaded: results are computed every 8 s only";
  EXPECT_THAT(announced_, ElementsAre(said));
  EXPECT_THAT(labels_, ElementsAre("warning"));
  EXPECT_THAT(marks_, ElementsAre(said));
  EXPECT_THAT(controller_->faults(), testing::IsEmpty());
}

TEST_F(ExperimentControllerRequests, EndsOnRequestEvenInAPause) {
  start(std::string(kPlanned) + kSteps);
  goTo(3);
  request(experiment_command_t::PAUSE);
  goTo(5);
  request(experiment_command_t::END, "enough");
  EXPECT_EQ(ending_, Ending::kRequested);
  EXPECT_EQ(why_, "ended by page: enough");
  controller_->conclude(why_);
  bus_.deliver();
  EXPECT_EQ(status().phase, experiment_status_t::ENDED);
  EXPECT_DOUBLE_EQ(status().elapsed, 3) << "pauses do not count";
  EXPECT_EQ(status().command_seq, 2);
}

TEST_F(ExperimentControllerRequests, ARequestToEndDoesNotHideAnUnmetCondition) {
  std::string file = tumbling();
  file.replace(file.find("hold_s = 10"), 11, "hold_s = 10\nif_not = \"safe\"");
  start(file);
  robot_answers_ = false;  // so that no robot confirms that it stands
  goTo(10.5);
  ASSERT_EQ(status().phase, experiment_status_t::LEAVING);
  ASSERT_FALSE(ending_);
  request(experiment_command_t::END, "enough");
  EXPECT_EQ(ending_, Ending::kUnmet);
  EXPECT_THAT(why_, HasSubstr("after 10 s its condition"));
  EXPECT_THAT(why_, HasSubstr("; ended by page: enough"));
}

TEST_F(ExperimentControllerRequests, FaultsOfTheDashboardAreOnlyMarks) {
  start(std::string(kPlanned) + kSteps);
  Node dashboard(bus_, loop_, {"dashboard", 0, 1});
  dashboard.fault("no port is free");
  bus_.deliver();
  EXPECT_THAT(controller_->faults(), IsEmpty());
  EXPECT_THAT(marks_, ElementsAre("dashboard: no port is free"));
  Node service(bus_, loop_, {"tracker_svc", 0, 1});
  service.fault("no camera");
  bus_.deliver();
  EXPECT_THAT(controller_->faults(), ElementsAre("tracker_svc: no camera"));
}

// The controller still waits for the robots to confirm their light table.
TEST_F(ExperimentControllerRequests, APauseBeforeTheScriptIsRefused) {
  experiment_ = parseExperiment(std::string(kPlanned) + "[[robots]]\nid = 2\n" + kSteps, "test");
  controller_.emplace(ServiceContext{node_, loop_, experiment_, "runs/requests-02"}, "",
                      [](Ending, const std::string&) {});
  request(experiment_command_t::PAUSE);
  EXPECT_TRUE(statuses_.empty()) << "the controller does not run yet";
  controller_->begin();
  loop_.runUntil(loop_.now() + 1'000'000);
  ASSERT_FALSE(controller_->inScript());
  EXPECT_EQ(status().phase, experiment_status_t::PREPARING);
  EXPECT_EQ(status().step, -1);
  request(experiment_command_t::PAUSE);
  EXPECT_THAT(status().refusal, HasSubstr("has not begun"));
}

}  // namespace
}  // namespace lab::runner
