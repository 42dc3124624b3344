#include "common/experiment/keys/layer_keys.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "common/experiment/keys/key_helpers.hpp"
#include "light/field/layer.hpp"

namespace lab::keys {
namespace {

using light::Blend;
using light::Follow;
using light::Gate;
using light::LayerKind;
using light::Waveform;
using light::WhenLost;

const std::array<Choice, 11> kKinds = {
    {choiceOf("uniform", LayerKind::kUniform), choiceOf("half_plane", LayerKind::kHalfPlane),
     choiceOf("disk", LayerKind::kDisk), choiceOf("ring", LayerKind::kRing),
     choiceOf("linear_gradient", LayerKind::kLinearGradient),
     choiceOf("radial_gradient", LayerKind::kRadialGradient),
     choiceOf("stripes", LayerKind::kStripes), choiceOf("checker", LayerKind::kChecker),
     choiceOf("image", LayerKind::kImage), choiceOf("noise", LayerKind::kNoise),
     choiceOf("wave", LayerKind::kWave)}};
const std::array<Choice, 5> kBlends = {
    {choiceOf("over", Blend::kOver), choiceOf("add", Blend::kAdd),
     choiceOf("multiply", Blend::kMultiply), choiceOf("max", Blend::kMax),
     choiceOf("min", Blend::kMin)}};
const std::array<Choice, 4> kWaveforms = {
    {choiceOf("none", Waveform::kSteady), choiceOf("sine", Waveform::kSine),
     choiceOf("square", Waveform::kSquare), choiceOf("telegraph", Waveform::kTelegraph)}};
const std::array<Choice, 3> kFollows = {{choiceOf("none", Follow::kNothing),
                                         choiceOf("robots", Follow::kRobots),
                                         choiceOf("trail", Follow::kTrail)}};
const std::array<Choice, 3> kWhenLost = {{choiceOf("remove", WhenLost::kRemove),
                                          choiceOf("hold", WhenLost::kHold),
                                          choiceOf("safe", WhenLost::kSafe)}};
const std::array<Choice, 4> kGates = {
    {choiceOf("none", Gate::kOpen), choiceOf("program", Gate::kProgram),
     choiceOf("inside", Gate::kInside), choiceOf("outside", Gate::kOutside)}};

const Range kRate{0, light::kLargestRate};
const Range kTime{.low = 0.001, .high = light::kLongestTime};
const auto kPlaced = {LayerKind::kHalfPlane,      LayerKind::kDisk,
                      LayerKind::kRing,           LayerKind::kLinearGradient,
                      LayerKind::kRadialGradient, LayerKind::kStripes,
                      LayerKind::kChecker,        LayerKind::kImage,
                      LayerKind::kNoise,          LayerKind::kWave};

void visitSeed(KeyVisitor& v, const Key& key, std::uint64_t& seed) {
  auto value = static_cast<std::int64_t>(seed);
  v.integer(key, 0, std::numeric_limits<std::int64_t>::max(), value);
  seed = static_cast<std::uint64_t>(value);
}

void visitImages(KeyVisitor& v, const Selector& kind, LayerSpec& layer) {
  light::Drive& drive = layer.drive;
  v.texts(kind.only({LayerKind::kImage},
                    writtenIf(!drive.images.empty(),
                              {"files", "image files that are shown in sequence"})),
          {.most = 200}, {.fewest = 1, .most = light::kMostImages}, drive.images);
  const bool sequence = !drive.images.empty();
  Key file = kind.only(
      {LayerKind::kImage},
      {"file",
       "image file; path relative to the experiment file; black gives intensity2, white intensity",
       Need::kRequired});
  if (sequence && file.applies == Applies::kYes) file.applies = Applies::kNo;
  file.condition += " and no files";
  v.text(file, {.most = 200}, layer.image);
  v.number(applicableIf(sequence, "files", {"images_per_s", "images of the sequence per second"}),
           {.low = 0, .high = light::kLargestRate, .above_low = true}, drive.image_rate);
  v.flag(applicableIf(sequence, "files",
                      {"loop", "the sequence repeats; false: its last image remains"}),
         drive.image_loop);
}

// light/field/layer.hpp lists which field holds which key.
void visitShape(KeyVisitor& v, const Selector& kind, LayerEntry& entry) {
  using enum LayerKind;
  LayerSpec& layer = entry.layer;
  const std::string middle = "middle of the arena; 0 with follow = \"robots\"";
  v.optionalNumber(kind.only(kPlaced, {.name = "x_cm",
                                       .meaning = "centre, or a point on the edge of a half plane",
                                       .default_text = middle}),
                   kPlace, entry.x);
  v.optionalNumber(
      kind.only(kPlaced, {.name = "y_cm", .meaning = "see x_cm", .default_text = middle}), kPlace,
      entry.y);
  v.number(
      kind.only({kHalfPlane, kLinearGradient, kStripes, kChecker, kImage, kNoise, kWave},
                {"angle_deg",
                 "direction, counter-clockwise from x; half_plane: towards the lit side; "
                 "linear_gradient: from intensity to intensity2; stripes: across the stripes; "
                 "checker, noise: of the pattern; image: of its lower edge; wave: of propagation"}),
      kAngle, layer.angle);
  v.number(
      kind.only({kDisk, kRing, kRadialGradient}, {"radius_cm", "outer radius", Need::kRequired}),
      kLength, layer.size);
  v.number(kind.only({kLinearGradient}, {"length_cm",
                                         "distance over which the light changes from intensity to "
                                         "intensity2, centred at x_cm, y_cm",
                                         Need::kRequired}),
           kLength, layer.size);
  v.number(kind.only({kStripes, kChecker, kWave},
                     {"period_cm",
                      "period of the stripes or of the wave; for checker, the side of a square",
                      Need::kRequired}),
           kLength, layer.size);
  v.number(
      kind.only({kNoise}, {"patch_cm", "distance over which the pattern's correlation falls to 1/e",
                           Need::kRequired}),
      kLength, layer.size);
  v.number(kind.only({kImage}, {"width_cm", "width of the image", Need::kRequired}), kLength,
           layer.size);
  v.number(kind.only({kRing, kRadialGradient},
                     {"inner_radius_cm",
                      "inner radius; inside it a radial gradient has the value of intensity"}),
           {0, 3000}, layer.inner);
  v.number(
      kind.only(
          {kStripes},
          {"share",
           "fraction of a period that has the value of intensity; the rest has that of intensity2",
           Need::kRequired}),
      {.low = 0, .high = 1, .above_low = true, .below_high = true}, layer.inner);
  v.number(kind.only({kImage}, {"height_cm", "height of the image", Need::kRequired}), kLength,
           layer.inner);
  v.number(kind.only({kHalfPlane, kDisk, kRing, kStripes, kChecker, kImage},
                     {"softness_cm", "width of the edges"}),
           {0, 3000}, layer.softness);
}

void visitIntensities(KeyVisitor& v, const Selector& kind, LayerEntry& entry) {
  using enum LayerKind;
  LayerSpec& layer = entry.layer;
  v.text(writtenIf(false, {"program",
                           "instead of intensity: the middle of the light band that selects this "
                           "program"}),
         {.most = 32, .bare = true}, entry.program);
  Key intensity{"intensity", "0: dark; 1: white of the projector", Need::kRequired};
  if (!entry.program.empty()) {
    intensity.applies = Applies::kNo;
    intensity.condition = "no program beside it";
  }
  v.number(intensity, kShare, layer.intensity);
  v.number(kind.only({kLinearGradient, kRadialGradient, kStripes, kChecker, kImage, kNoise, kWave},
                     {"intensity2", "intensity at the other end or in the other part"}),
           kShare, layer.intensity2);
}

void visitMotion(KeyVisitor& v, const Selector& kind, LayerEntry& entry) {
  light::Drive& drive = entry.layer.drive;
  const Range speed{-100 * light::kLargestSpeed, 100 * light::kLargestSpeed};
  v.number(kind.only(kPlaced, writtenIf(drive.vx != 0, {"vx_cm_s", "speed of the layer along x"})),
           speed, drive.vx);
  v.number(kind.only(kPlaced, writtenIf(drive.vy != 0, {"vy_cm_s", "speed of the layer along y"})),
           speed, drive.vy);
  v.number(
      kind.only(kPlaced,
                writtenIf(drive.spin != 0,
                          {"spin_deg_s",
                           "rate at which the layer turns about x_cm, y_cm, counter-clockwise"})),
      kAngle, drive.spin);
  v.number(kind.only({LayerKind::kWave}, {"speed_cm_s", "speed of the crests, along angle_deg"}),
           kSpeed, entry.speed);
  v.number(kind.only({LayerKind::kNoise},
                     {"change_per_s", "rate at which the pattern changes into an independent one"}),
           kRate, entry.change);
}

void visitWaveform(KeyVisitor& v, const Selector& kind, LayerSpec& layer) {
  using enum Waveform;
  light::Drive& drive = layer.drive;
  const Selector waveform(
      v,
      writtenIf(drive.waveform != kSteady, {"waveform",
                                            "how the intensity varies between its own value and "
                                            "low; telegraph: switches at random times"}),
      kWaveforms, drive.waveform);
  const auto any = {kSine, kSquare, kTelegraph};
  v.number(waveform.only(
               any, {"period_s",
                     "period of the waveform; for telegraph, twice the mean time between switches",
                     Need::kRequired}),
           kTime, drive.period);
  v.number(waveform.only(any, {"low", "intensity at the lower end"}), kShare, drive.low);
  v.number(
      waveform.only(any, {"start", "phase at the start of the step, as a fraction of a period"}),
      kShare, drive.start);
  // One key serves both: pattern and telegraph use different random streams.
  const bool noise = layer.kind == static_cast<std::int8_t>(LayerKind::kNoise);
  const bool telegraph = drive.waveform == kTelegraph;
  Key seed =
      kind.only({LayerKind::kNoise},
                {"seed", "selects the random pattern, or the random switching times of telegraph"});
  seed.condition += " or waveform = \"telegraph\"";
  if (telegraph) seed.applies = Applies::kYes;
  std::uint64_t value = noise ? layer.seed : drive.seed;
  visitSeed(v, seed, value);
  if (noise) layer.seed = value;
  if (telegraph) drive.seed = value;
}

void visitFollow(KeyVisitor& v, const Selector& kind, light::Drive& drive) {
  using enum Follow;
  const Selector follow(
      v,
      kind.only(kPlaced,
                writtenIf(drive.follow != kNothing,
                          {"follow",
                           "robots: a copy of the layer on each robot, with x_cm, y_cm and "
                           "angle_deg in the robot's frame; trail: a trail that robots deposit"})),
      kFollows, drive.follow);
  const auto both = {kRobots, kTrail};
  v.integers(follow.only(both, {.name = "robots",
                                .meaning = "ids of the robots that are followed",
                                .default_text = "every one"}),
             1, kLargestId, {.fewest = 0, .most = light::kMostFollowed}, drive.robots);
  v.flag(follow.only({kRobots}, {"predict",
                                 "use the predicted pose at the time when the light arrives, "
                                 "instead of the last observed one"}),
         drive.predict);
  v.number(follow.only(both, {"stale_s", "a robot whose last pose is older is lost"}), kTime,
           drive.stale);
  enumerate(
      v,
      follow.only(
          both,
          {"when_lost",
           "what happens to the copy of a lost robot; remove: it disappears; hold: it remains "
           "where it was; safe: the safe light is shown until the robot is found again"}),
      kWhenLost, drive.when_lost);
  v.number(follow.only({kTrail}, {"rate_per_s", "intensity per second that a robot deposits"}),
           kRate, drive.rate);
  v.number(follow.only({kTrail}, {"decay_per_s", "decay rate of the deposited trail"}), kRate,
           drive.decay);
  v.number(
      follow.only({kTrail}, {"diffusion_cm2_s", "diffusion coefficient of the deposited trail"}),
      {0, 1e4 * light::kLargestDiffusion}, drive.diffusion);
}

void visitGate(KeyVisitor& v, light::Drive& drive) {
  using enum Gate;
  const Selector gate(
      v,
      writtenIf(drive.gate != kOpen,
                {"gate",
                 "the layer is shown only while a robot meets this condition; program: it runs "
                 "gate_program; inside, outside: it is inside or outside the circle"}),
      kGates, drive.gate);
  std::int64_t robot = drive.gate_robot;
  v.integer(
      gate.only(
          {kProgram, kInside, kOutside},
          {"gate_robot",
           "id of that robot; 0: the followed robot, or any robot if the layer follows none"}),
      0, kLargestId, robot);
  drive.gate_robot = static_cast<std::int32_t>(robot);
  v.text(gate.only({kProgram}, {"gate_program", "name of the program", Need::kRequired}),
         {.most = 32, .bare = true}, drive.gate_program);
  const auto circle = {kInside, kOutside};
  v.number(gate.only(circle, {"gate_x_cm", "the circle's middle", Need::kRequired}), kPlace,
           drive.gate_x);
  v.number(gate.only(circle, {"gate_y_cm", "the circle's middle", Need::kRequired}), kPlace,
           drive.gate_y);
  v.number(gate.only(circle, {"gate_radius_cm", "the circle's radius", Need::kRequired}), kLength,
           drive.gate_radius);
}

void visitCrowd(KeyVisitor& v, CrowdRule& crowd) {
  const TextRule name{.most = 48, .bare = true};
  const Range any{-1e6, 1e6};
  v.text(writtenIf(!crowd.gate.empty(),
                   {"gate", "collective number: the layer is shown while it is above or below"}),
         name, crowd.gate);
  v.text(writtenIf(!crowd.hold.empty(),
                   {"hold", "collective number that the intensity holds at target, by a PI rule"}),
         name, crowd.hold);
  v.flag({"quorum",
          "the layer follows only robots whose local packing fraction is above or below; needs "
          "follow = \"robots\""},
         crowd.quorum);
  const bool number = !crowd.gate.empty() || !crowd.hold.empty();
  v.text(applicableIf(number, "gate or hold",
                      writtenIf(!crowd.program.empty(),
                                {"program",
                                 "the number of this program; without it, that of all "
                                 "robots"})),
         {.most = 32, .bare = true}, crowd.program);
  const bool bounds = !crowd.gate.empty() || crowd.quorum;
  v.optionalNumber(
      applicableIf(bounds, "gate or quorum",
                   {"above", "in the unit of the report (cm/s)", Need::kOptional, "-"}),
      any, crowd.above);
  v.optionalNumber(
      applicableIf(bounds, "gate or quorum", {"below", "see above", Need::kOptional, "-"}), any,
      crowd.below);
  const bool hold = !crowd.hold.empty();
  v.number(applicableIf(hold, "hold", {"target", "in the unit of the report", Need::kRequired}),
           any, crowd.target);
  v.number(applicableIf(hold, "hold",
                        {"gain",
                         "change of the intensity per unit of target minus number; negative where "
                         "light lowers the number",
                         Need::kRequired}),
           {-1000, 1000}, crowd.gain);
  v.number(applicableIf(hold, "hold",
                        {"integral_time_s", "integral time of the PI rule; 0: proportional only"}),
           {0, 100000}, crowd.integral_time);
  v.number(applicableIf(hold, "hold", {"lowest", "lowest intensity"}), kShare, crowd.lowest);
  v.number(applicableIf(hold, "hold", {"highest", "highest intensity"}), kShare, crowd.highest);
}

}  // namespace

void visitLayer(KeyVisitor& v, LayerEntry& entry) {
  LayerSpec& layer = entry.layer;
  auto layer_kind = static_cast<LayerKind>(layer.kind);
  auto blend = static_cast<Blend>(layer.blend);
  const Selector kind(v, {"kind", "what is painted", Need::kRequired}, kKinds, layer_kind);
  enumerate(v, {"blend", "how the layer changes what the layers before it painted"}, kBlends,
            blend);
  layer.kind = static_cast<std::int8_t>(layer_kind);
  layer.blend = static_cast<std::int8_t>(blend);
  visitImages(v, kind, layer);
  visitShape(v, kind, entry);
  visitIntensities(v, kind, entry);
  visitMotion(v, kind, entry);
  visitWaveform(v, kind, layer);
  visitFollow(v, kind, layer.drive);
  visitGate(v, layer.drive);
  v.inLineTable({.name = "crowd",
                 .meaning = "how the layer depends on what the robots do together",
                 .default_text = "-"},
                entry.has_crowd, [&] { visitCrowd(v, layer.crowd); });
}

}  // namespace lab::keys
