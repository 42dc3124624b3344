#include "common/experiment/keys/light_keys.hpp"

#include <array>

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
    "a measured number that has to be known: D_r, v, v_a, V, D_t, gamma, tau_r, D, L_s or D_slope, "
    "as the program has them";
constexpr const char* kOfProgram = "of which it is";
constexpr const char* kKnown =
    "standard error over value that is good enough, of all that the run has seen so far";
constexpr const char* kRobot = "the one robot that is meant; without it every one";
const TextRule kEstimateRule{.most = 20, .bare = true};
const TextRule kProgramRule{.most = 32, .bare = true};

void visitOneRobot(KeyVisitor& v, std::int32_t& robot) {
  std::int64_t id = robot;
  v.integer(writtenIf(id != 0, {"robot", kRobot}), 1, kLargestId, id);
  robot = static_cast<std::int32_t>(id);
}

// Which of the three kinds of condition it is, is a matter of what is there.
void visitUntil(KeyVisitor& v, Until& until) {
  using enum Region;
  v.text(writtenIf(!until.estimate.empty(), {"estimate", kEstimate}), kEstimateRule,
         until.estimate);
  const bool estimate = !until.estimate.empty();
  v.text(applicableIf(estimate, "estimate", {"program", kOfProgram, Need::kRequired}), kProgramRule,
         until.program);
  v.number(applicableIf(estimate, "estimate", {"relative_error", kKnown, Need::kRequired}),
           {.low = 0, .high = 1, .above_low = true}, until.relative_error);
  v.integer(
      writtenIf(until.tumbles != 0,
                {"tumbles", "how many, since the step began, of all robots together or of one"}),
      1, 1'000'000'000, until.tumbles);
  visitOneRobot(v, until.robot);
  const Selector region(
      v, writtenIf(until.region != kNone, {"region", "where a robot's axis has to be"}), kRegions,
      until.region);
  const auto both = {kCircle, kRectangle};
  Key who = region.only(both, {"robots", "whether one of them has to be there or all at a time"});
  if (until.robot != 0 && who.applies == Applies::kYes) who.applies = Applies::kNo;
  who.condition += " and without robot";
  enumerate(v, who, kWho, until.who);
  v.number(region.only(both, {"x_cm", "its middle", Need::kRequired}), kPlace, until.x);
  v.number(region.only(both, {"y_cm", "its middle", Need::kRequired}), kPlace, until.y);
  v.number(region.only({kCircle}, {"radius_cm", "its radius", Need::kRequired}), kLength,
           until.radius);
  v.number(region.only({kRectangle}, {"width_cm", "along x", Need::kRequired}), kLength,
           until.width);
  v.number(region.only({kRectangle}, {"height_cm", "along y", Need::kRequired}), kLength,
           until.height);
}

void visitStep(KeyVisitor& v, StepEntry& step) {
  v.text({.name = "label", .meaning = "for reports", .default_text = "step 1, step 2, ..."},
         {.most = 60}, step.label);
  v.optionalNumber({.name = "at_s",
                    .meaning = "when the step begins; the first at 0, the others in rising order",
                    .default_text = "needed where there is no hold_s"},
                   {0, kLongestRun}, step.at);
  v.optionalNumber({"hold_s",
                    "how long the step is shown, with until at most; all steps have at_s or all "
                    "have hold_s",
                    Need::kOptional, "-"},
                   {.low = 0, .high = kLongestRun, .above_low = true}, step.hold);
  v.inLineTable({.name = "until",
                 .meaning = "the step ends as soon as this has come about; with hold_s, which is "
                            "then the limit",
                 .default_text = "-"},
                step.has_until, [&] { visitUntil(v, step.until); });
  enumerate(v,
            applicableIf(step.has_until, "until",
                         {"if_not",
                          "what follows when the limit comes first: the next step, the run's "
                          "end, or the safe light and then the run's end"}),
            kIfNot, step.if_not);
  v.text(writtenIf(!step.back_to.empty(),
                   {"back_to",
                    "label of a step before this one, or of this one: the steps from "
                    "there to here are shown several times; with hold_s"}),
         {.most = 60}, step.back_to);
  v.integer(applicableIf(!step.back_to.empty(), "back_to",
                         {"times", "how often they are shown in all", Need::kRequired}),
            2, 100'000, step.times);
  v.number({"ramp_s", "cross-fade from the step before, as long at most as the step"}, {0, 3600},
           step.ramp);
  visitList(v, {"layers", "painted one upon the other, from the dark", Need::kRequired},
            {.fewest = 1, .most = light::kMostLayers, .in_line = true}, step.layers,
            [&](LayerEntry& layer) { visitLayer(v, layer); });
}

}  // namespace

void visitStopOn(KeyVisitor& v, StopOn& on) {
  enumerate(v,
            writtenIf(on != StopOn::kAll,
                      {"stop_on", "whether all rules of stop_when have to hold at a time, or any"}),
            kStopOn, on);
}

void visitStopRule(KeyVisitor& v, StopRule& rule) {
  v.text({"estimate", kEstimate, Need::kRequired}, kEstimateRule, rule.until.estimate);
  v.text({"program", kOfProgram, Need::kRequired}, kProgramRule, rule.until.program);
  v.number({"relative_error_percent", kKnown, Need::kRequired},
           {.low = 0, .high = 100, .above_low = true}, rule.until.relative_error);
  visitOneRobot(v, rule.until.robot);
  v.number({"at_least_s", "of the script, before which the rule does not count"}, {0, kLongestRun},
           rule.at_least);
}

void visitLight(KeyVisitor& v, ExperimentForm& form) {
  LightScript& light = form.common.light;
  v.number({"frame_rate_hz", "frames a second of the projector"}, {1, 500}, light.frame_rate);
  v.number({"safe_intensity", "shown everywhere when nobody commands the light"}, kShare,
           light.safe_intensity);
  v.flag({"repeat", "the steps begin again when the last one has ended"}, light.repeat);
  v.optionalNumber({.name = "length_s",
                    .meaning = "when the last step ends, only with repeat; the sum where steps "
                               "have hold_s",
                    .default_text = "-"},
                   {.low = 0, .high = kLongestRun, .above_low = true}, form.light_length);
  visitList(v, {"steps", "what is shown when"}, {.fewest = 0, .most = 1000}, form.light_steps,
            [&](StepEntry& step) { visitStep(v, step); });
}

// A robot in the corner has its axis 3.75 cm from both walls, and a light sensor 3 cm from its
// axis: that comes as near as 1.63 cm to both.
constexpr double kLargestPatch_cm = 1.6;

void visitProjector(KeyVisitor& v, Projector& projector) {
  v.text({"display",
          "headless: no window, and sim_svc shows the light; else the name or number of a display "
          "(projector_ctl --list-displays)"},
         {.most = 100}, projector.display);
  v.text({.name = "calibration",
          .meaning = "projector.json of lab calibrate projector; the arena fills the picture where "
                     "empty",
          .default_text = "empty"},
         {.most = 400}, projector.calibration);
  v.text({.name = "light_calibration",
          .meaning = "light.json of lab calibrate light; intensities are proportional to the "
                     "pixels' values where empty",
          .default_text = "empty"},
         {.most = 400}, projector.light_calibration);
  v.number({"latency_ms", "from the display's swap of a picture to its light on the arena"},
           {0, 1000}, projector.latency);
  v.flag({"overlay", "words over the picture: frame rate, command, calibration"},
         projector.overlay);
  v.number({"sync_patch_cm",
            "side of a square in the corner at the origin that turns with every command, for the "
            "camera to see; 0: none. Only with camera.tracker = \"camera\""},
           {0, kLargestPatch_cm}, projector.sync_patch);
  std::int64_t width = projector.width;
  std::int64_t height = projector.height;
  v.integer({"width_px", "of the simulated projector's picture"}, 160, 8192, width);
  v.integer({"height_px", "of the simulated projector's picture"}, 120, 8192, height);
  projector.width = static_cast<int>(width);
  projector.height = static_cast<int>(height);
  v.number(
      {"keystone_percent", "how much wider the simulated projector's picture is at its far side"},
      {-40, 40}, projector.keystone);
  v.number({"barrel_percent", "how much the simulated projector's lens pulls the corners in"},
           {-20, 20}, projector.barrel);
  v.number({"offset_x_cm", "where the simulated projector's picture is shifted to"}, {-50, 50},
           projector.offset_x);
  v.number({"offset_y_cm", "see offset_x_cm"}, {-50, 50}, projector.offset_y);
  v.number({"gamma", "of the simulated projector: light is the pixel's value to this power"},
           {0.2, 5}, projector.gamma);
  v.number({"vignetting_percent", "how much darker the corners of its picture are"}, {0, 80},
           projector.vignetting);
  v.number({"sheet_cm",
            "a white sheet so high above the floor covers the simulated arena, for calibrating; 0: "
            "none"},
           {0, 50}, projector.sheet);
}

}  // namespace lab::keys
