#include "common/experiment/keys/light_keys.hpp"

#include <array>
#include <cstdint>
#include <string>

#include "common/experiment/keys/key_helpers.hpp"
#include "common/experiment/keys/layer_keys.hpp"
#include "light/field/layer.hpp"

namespace lab::keys {
namespace {

const std::array<Choice, 2> kRegions = {
    {choiceOf("circle", Region::kCircle), choiceOf("rectangle", Region::kRectangle)}};
const std::array<Choice, 2> kWho = {{choiceOf("any", Who::kAny), choiceOf("all", Who::kAll)}};
const std::array<Choice, 3> kIfNot = {
    {choiceOf("next", IfNot::kNext), choiceOf("end", IfNot::kEnd), choiceOf("safe", IfNot::kSafe)}};

const std::array<Choice, 2> kStopOn = {
    {choiceOf("all", StopOn::kAll), choiceOf("any", StopOn::kAny)}};

constexpr const char* kEstimate =
    "name of a measured number: D_r, v, v_a, V, D_t, gamma, tau_r, D, L_s or D_slope, depending on "
    "the program";
constexpr const char* kOfProgram = "the program to which the measured number belongs";
constexpr const char* kRelativeError =
    "largest allowed standard error as a fraction of the value (0.05 is 5 %), from all data of the "
    "run so far";
constexpr const char* kRelativeErrorPercent =
    "largest allowed standard error in percent of the value (5 is 5 %), from all data of the run "
    "so far";
constexpr const char* kConditionRobot =
    "id of one robot; without this key an estimate or tumbles are those of all robots together, "
    "and the key robots says how many must be in a region";
constexpr const char* kRuleRobot =
    "id of one robot; without this key the estimate is that of all robots together";
constexpr const char* kObservable =
    "name of a collective number (docs/collective.md), such as polar_order, largest_cluster, speed "
    "or share_in_REGION";
constexpr const char* kAbove =
    "its mean over over_s is above this, in the unit of the report (cm/s)";
constexpr const char* kBelow = "its mean over over_s is below this, in the unit of the report";
constexpr const char* kOver = "time over which the collective number is averaged";
const TextRule kObservableRule{.most = 48, .bare = true};
const Range kAnyNumber{-1e6, 1e6};
const Range kOverTime{.low = 0, .high = 3600};
const TextRule kEstimateRule{.most = 20, .bare = true};
const TextRule kProgramRule{.most = 32, .bare = true};

void visitOneRobot(KeyVisitor& v, const char* meaning, std::int32_t& robot) {
  std::int64_t id = robot;
  v.integer(writtenIf(id != 0, {"robot", meaning}), 1, kLargestId, id);
  robot = static_cast<std::int32_t>(id);
}

void visitBounds(KeyVisitor& v, bool applies, EndCondition& until) {
  v.optionalNumber(applicableIf(applies, "observable", {"above", kAbove, Need::kOptional, "-"}),
                   kAnyNumber, until.above);
  v.optionalNumber(applicableIf(applies, "observable", {"below", kBelow, Need::kOptional, "-"}),
                   kAnyNumber, until.below);
  v.number(applicableIf(applies, "observable", {"over_s", kOver}), kOverTime, until.over);
}

// There are four kinds of condition: estimate, observable, tumbles and region. The key that is
// present decides.
void visitUntil(KeyVisitor& v, EndCondition& until) {
  using enum Region;
  v.text(writtenIf(!until.estimate.empty(), {"estimate", kEstimate}), kEstimateRule,
         until.estimate);
  v.text(writtenIf(!until.observable.empty(), {"observable", kObservable}), kObservableRule,
         until.observable);
  const bool observable = !until.observable.empty();
  const bool number = !until.estimate.empty() || observable;
  const Need need = observable ? Need::kOptional : Need::kRequired;
  Key program = applicableIf(number, "estimate or observable", {"program", kOfProgram, need});
  if (observable) program = writtenIf(!until.program.empty(), program);
  v.text(program, kProgramRule, until.program);
  Key error =
      applicableIf(number, "estimate or observable", {"relative_error", kRelativeError, need});
  if (observable) error = writtenIf(until.relative_error != 0, error);
  v.number(error, {.low = 0, .high = 1, .above_low = true}, until.relative_error);
  visitBounds(v, observable, until);
  v.integer(writtenIf(until.tumbles != 0,
                      {"tumbles",
                       "number of tumbles since the step began, of all robots together or of one"}),
            1, 1'000'000'000, until.tumbles);
  visitOneRobot(v, kConditionRobot, until.robot);
  const Selector region(
      v, writtenIf(until.region != kNone, {"region", "region in which a robot's centre must be"}),
      kRegions, until.region);
  const auto both = {kCircle, kRectangle};
  Key who = region.only(
      both, {"robots", "whether one robot must be in the region, or all at the same time"});
  if (until.robot != 0 && who.applies == Applies::kYes) who.applies = Applies::kNo;
  who.condition += " and without robot";
  enumerate(v, who, kWho, until.who);
  v.number(region.only(both, {"x_cm", "centre of the region", Need::kRequired}), kPlace, until.x);
  v.number(region.only(both, {"y_cm", "centre of the region", Need::kRequired}), kPlace, until.y);
  v.number(region.only({kCircle}, {"radius_cm", "radius of the circle", Need::kRequired}), kLength,
           until.radius);
  v.number(
      region.only({kRectangle}, {"width_cm", "size of the rectangle along x", Need::kRequired}),
      kLength, until.width);
  v.number(
      region.only({kRectangle}, {"height_cm", "size of the rectangle along y", Need::kRequired}),
      kLength, until.height);
}

void visitStep(KeyVisitor& v, StepEntry& step) {
  v.text({.name = "label",
          .meaning = "name of the step in dashboard and report",
          .default_text = "step 1, step 2, ..."},
         {.most = 60}, step.label);
  v.optionalNumber({.name = "at_s",
                    .meaning = "start of the step; 0 for the first one, then increasing by at "
                               "least 0.01",
                    .default_text = "needed where there is no hold_s"},
                   {0, kLongestRun}, step.at);
  v.optionalNumber({"hold_s",
                    "duration of the step, at least 0.01; with until, the longest duration; either "
                    "all steps have at_s or all have hold_s",
                    Need::kOptional, "-"},
                   {.low = 0, .high = kLongestRun, .above_low = true}, step.hold);
  v.inLineTable({.name = "until",
                 .meaning = "the step ends as soon as this condition is met; requires hold_s, "
                            "which is then the limit",
                 .default_text = "-"},
                step.has_until, [&] { visitUntil(v, step.until); });
  enumerate(v,
            applicableIf(step.has_until, "until",
                         {"if_not",
                          "what follows if the limit is reached first: the next step, the run's "
                          "end, or the safe light and then the run's end"}),
            kIfNot, step.if_not);
  v.text(writtenIf(!step.back_to.empty(), {"back_to",
                                           "label of an earlier step, or of this one: the steps "
                                           "from there to this one are repeated; requires hold_s"}),
         {.most = 60}, step.back_to);
  v.integer(applicableIf(!step.back_to.empty(), "back_to",
                         {"times", "how often these steps are shown in total", Need::kRequired}),
            2, 100'000, step.times);
  v.number(
      {"ramp_s", "duration of the cross-fade from the previous step, at most that of the step"},
      {0, 3600}, step.ramp);
  visitList(v, {"layers", "painted one over the other, starting with darkness", Need::kRequired},
            {.fewest = 1, .most = light::kMostLayers, .in_line = true}, step.layers,
            [&](LayerEntry& layer) { visitLayer(v, layer); });
}

}  // namespace

void visitStopOn(KeyVisitor& v, StopOn& on) {
  enumerate(v,
            writtenIf(on != StopOn::kAll, {"stop_on",
                                           "all: the run ends when all rules of stop_when hold at "
                                           "the same time; any: when one holds"}),
            kStopOn, on);
}

void visitStopRule(KeyVisitor& v, StopRule& rule) {
  EndCondition& until = rule.until;
  v.text(writtenIf(!until.observable.empty(),
                   {"observable", std::string("instead of estimate: ") + kObservable}),
         kObservableRule, until.observable);
  const bool observable = !until.observable.empty();
  const Need need = observable ? Need::kOptional : Need::kRequired;
  Key estimate{"estimate", kEstimate, need};
  if (observable) estimate = applicableIf(false, "no observable", estimate);
  v.text(estimate, kEstimateRule, until.estimate);
  Key program{"program", kOfProgram, need};
  if (observable) program = writtenIf(!until.program.empty(), program);
  v.text(program, kProgramRule, until.program);
  Key error{"relative_error_percent", kRelativeErrorPercent, need};
  if (observable) error = writtenIf(until.relative_error != 0, error);
  v.number(error, {.low = 0, .high = 100, .above_low = true}, until.relative_error);
  visitBounds(v, observable, until);
  visitOneRobot(v, kRuleRobot, rule.until.robot);
  v.number({"at_least_s", "time of the script before which the rule is ignored"}, {0, kLongestRun},
           rule.at_least);
}

void visitLight(KeyVisitor& v, ExperimentForm& form) {
  LightScript& light = form.common.light;
  v.number({"frame_rate_hz", "frames per second of the projector"}, {1, 500}, light.frame_rate);
  v.number({"safe_intensity", "intensity that is shown everywhere while no command is valid"},
           kShare, light.safe_intensity);
  v.flag({"repeat", "the steps are repeated after the last one"}, light.repeat);
  v.optionalNumber({.name = "length_s",
                    .meaning = "end of the last step, which is the length of one pass; required "
                               "with at_s and repeat, not allowed otherwise",
                    .default_text = "-"},
                   {.low = 0, .high = kLongestRun, .above_low = true}, form.light_length);
  visitList(v, {"steps", "The steps of the light"}, {.fewest = 0, .most = 1000}, form.light_steps,
            [&](StepEntry& step) { visitStep(v, step); });
}

// So small that no light sensor gets onto the patch: a robot's axis is at least 3.75 cm from both
// walls of the corner, and so a sensor 3 cm from the axis at least 1.63 cm from one of them.
constexpr double kLargestPatch_cm = 1.6;

void visitProjector(KeyVisitor& v, Projector& projector) {
  v.text({"display",
          "headless: no window, for simulated robots; else the name or number of a display "
          "(projector_ctl --list-displays)"},
         {.most = 100}, projector.display);
  v.text({.name = "calibration",
          .meaning =
              "projector.json of lab calibrate projector; if empty, the arena fills the picture",
          .default_text = "empty"},
         {.most = 400}, projector.calibration);
  v.text({.name = "light_calibration",
          .meaning = "light.json of lab calibrate light; if empty, intensities are proportional to "
                     "the pixels' values",
          .default_text = "empty"},
         {.most = 400}, projector.light_calibration);
  v.number({"latency_ms", "time from the display's swap of a picture to its light on the arena"},
           {0, 1000}, projector.latency);
  v.flag({"overlay", "text over the picture: frame rate, command, calibration"}, projector.overlay);
  v.number({"sync_patch_cm",
            "side of a square in the corner at the origin that toggles with every command, so that "
            "the camera can time it; 0: none. Only with camera.tracker = \"camera\""},
           {0, kLargestPatch_cm}, projector.sync_patch);
  std::int64_t width = projector.width;
  std::int64_t height = projector.height;
  v.integer({"width_px", "width of the simulated projector's picture"}, 160, 8192, width);
  v.integer({"height_px", "height of the simulated projector's picture"}, 120, 8192, height);
  projector.width = static_cast<int>(width);
  projector.height = static_cast<int>(height);
  v.number({"keystone_percent",
            "by how much the simulated projector's picture is wider at its far side"},
           {-40, 40}, projector.keystone);
  v.number(
      {"barrel_percent", "by how much the simulated projector's lens moves the corners inwards"},
      {-20, 20}, projector.barrel);
  v.number({"offset_x_cm", "shift of the simulated projector's picture"}, {-50, 50},
           projector.offset_x);
  v.number({"offset_y_cm", "see offset_x_cm"}, {-50, 50}, projector.offset_y);
  v.number({"gamma", "gamma of the simulated projector: light is the pixel's value to this power"},
           {0.2, 5}, projector.gamma);
  v.number({"vignetting_percent",
            "by how much the corners of the simulated projector's picture are darker"},
           {0, 80}, projector.vignetting);
  v.number({"sheet_cm",
            "height above the floor of a white sheet that covers the simulated arena for "
            "calibration; 0: none"},
           {0, 50}, projector.sheet);
}

}  // namespace lab::keys
