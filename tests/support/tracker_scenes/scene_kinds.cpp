#include "tests/support/tracker_scenes/scene_kinds.hpp"

#include <stdexcept>
#include <string>

namespace lab::cases {
namespace {

// The project's own limits. There are none for light with strong gradients (waves, noise), nor for
// wrong poses in ambient light alone and in light with gradients or edges.
constexpr AcceptanceLimits kAll{.recall = 1, .wrong = 0};
constexpr AcceptanceLimits kAllHonest{.recall = 1, .wrong = 0, .honest = true};
constexpr AcceptanceLimits kClean{
    .recall = 1, .wrong = 0, .position = 0.012, .heading = 0.03, .honest = true};
constexpr AcceptanceLimits kDim{.recall = 1, .wrong = 0, .position = 0.03, .honest = true};
constexpr AcceptanceLimits kDimJpeg{.recall = 0.995, .wrong = 0, .honest = true};
constexpr AcceptanceLimits kDark{.recall = 0.99, .honest = true};
constexpr AcceptanceLimits kSlope{.recall = 0.995, .position = 0.015};
constexpr AcceptanceLimits kEdge{.recall = 0.995};
constexpr AcceptanceLimits kEdges{.recall = 0.995,
                                  .position = 0.2};  // an edge crosses nearly every circle
constexpr AcceptanceLimits kHard{.recall = 0.99};
constexpr AcceptanceLimits kFloor{.recall = 1, .wrong = 0.1};  // pairs of discs on the floor
// Under a reflection black paint may be as bright as white paint.
constexpr AcceptanceLimits kGlare{.recall = 1, .wrong = 0, .recall_known = 0.985};

constexpr SceneKind kWorst{.name = "worst_720",
                           .robots = 50,
                           .shown = SceneLight::kHalf,
                           .low = 0.12,
                           .blur = 1.5,
                           .read_noise = 2,
                           .speed = 0.1,
                           .debris = 12,
                           .decoys = 3,
                           .glares = 2,
                           .limits = kHard};

constexpr SceneKind with(SceneKind kind, const char* name, auto change) {
  kind.name = name;
  change(kind);
  return kind;
}

constexpr SceneKind kKinds[] = {
    {.name = "clean_720", .limits = kClean},
    {.name = "clean_1080", .rows = 1080, .limits = kAllHonest},
    {.name = "light_uniform05", .high = 0.05, .limits = kAllHonest},
    {.name = "light_uniform12", .high = 0.12, .limits = kDim},
    {.name = "light_over", .brightness = 1.5, .limits = kAll},
    {.name = "light_ambient", .high = 0, .limits = kDark},
    {.name = "light_ambient_1080", .rows = 1080, .high = 0, .limits = kDark},
    {.name = "light_half_100_30", .shown = SceneLight::kHalf, .low = 0.30, .limits = kEdge},
    {.name = "light_half_100_12", .shown = SceneLight::kHalf, .low = 0.12, .limits = kEdge},
    {.name = "light_half_100_0", .shown = SceneLight::kHalf, .low = 0, .limits = kEdge},
    {.name = "light_half_100_30_1080",
     .rows = 1080,
     .shown = SceneLight::kHalf,
     .low = 0.30,
     .limits = kEdge},
    {.name = "light_half_100_12_1080",
     .rows = 1080,
     .shown = SceneLight::kHalf,
     .low = 0.12,
     .limits = kEdge},
    {.name = "light_half_100_0_1080",
     .rows = 1080,
     .shown = SceneLight::kHalf,
     .low = 0,
     .limits = kEdge},
    {.name = "light_gradient", .shown = SceneLight::kGradient, .low = 0.12, .limits = kSlope},
    {.name = "light_gradient_1080",
     .rows = 1080,
     .shown = SceneLight::kGradient,
     .low = 0.12,
     .limits = kEdge},
    {.name = "light_radial",
     .shown = SceneLight::kRadial,
     .low = 0.10,
     .size = 0.6,
     .limits = kEdge},
    {.name = "light_stripes",
     .shown = SceneLight::kStripes,
     .low = 0.35,
     .size = 0.08,
     .limits = kEdges},
    {.name = "light_stripes_dark",
     .shown = SceneLight::kStripes,
     .low = 0.10,
     .size = 0.08,
     .limits = kEdges},
    {.name = "light_stripes_fine",
     .shown = SceneLight::kStripes,
     .low = 0.35,
     .size = 0.03,
     .limits = kEdges},
    {.name = "light_checker",
     .shown = SceneLight::kChecker,
     .low = 0.25,
     .size = 0.10,
     .limits = kEdges},
    {.name = "light_disks",
     .shown = SceneLight::kDisks,
     .low = 0.12,
     .size = 0.10,
     .limits = kEdge},
    {.name = "light_disks_small",
     .shown = SceneLight::kDisks,
     .low = 0.12,
     .size = 0.05,
     .limits = kEdge},
    {.name = "light_disks_black",
     .shown = SceneLight::kDisks,
     .low = 0.02,
     .size = 0.10,
     .limits = kEdge},
    {.name = "light_spots",
     .shown = SceneLight::kRobots,
     .low = 0.25,
     .size = 0.05,
     .limits = kEdge},
    {.name = "light_spots_3cm",
     .shown = SceneLight::kRobots,
     .low = 0.12,
     .size = 0.03,
     .limits = kEdge},
    {.name = "light_wave", .shown = SceneLight::kWave, .low = 0.10, .size = 0.10},
    {.name = "light_noise", .shown = SceneLight::kNoise, .low = 0.10, .size = 0.06},
    {.name = "geo_pairs", .places = RobotPlacement::kPairs, .limits = kAll},
    {.name = "geo_chains_half",
     .shown = SceneLight::kHalf,
     .low = 0.12,
     .places = RobotPlacement::kChains,
     .limits = kEdge},
    {.name = "geo_hex", .places = RobotPlacement::kHexagons, .limits = kAll},
    {.name = "geo_walls", .places = RobotPlacement::kAtWalls, .limits = kAll},
    {.name = "dis_empty", .robots = 0, .limits = kAll},
    {.name = "dis_debris", .debris = 25, .limits = kAll},
    {.name = "dis_decoys", .decoys = 10, .limits = kAll},
    {.name = "dis_floorpair", .robots = 5, .floor_pairs = 4, .limits = kFloor},
    {.name = "dis_glare", .glares = 4, .limits = kGlare},
    {.name = "dis_nobody_half",
     .robots = 0,
     .shown = SceneLight::kHalf,
     .low = 0.12,
     .debris = 25,
     .decoys = 10,
     .floor_pairs = 10,
     .limits = kFloor},
    {.name = "dis_nobody_checker",
     .robots = 0,
     .shown = SceneLight::kChecker,
     .low = 0.25,
     .size = 0.05,
     .debris = 25,
     .decoys = 10,
     .floor_pairs = 10,
     .limits = kFloor},
    {.name = "dis_nobody_stripes",
     .robots = 0,
     .shown = SceneLight::kStripes,
     .low = 0.10,
     .size = 0.03,
     .debris = 25,
     .decoys = 10,
     .floor_pairs = 10,
     .limits = kFloor},
    {.name = "dis_nobody_disks",
     .robots = 0,
     .shown = SceneLight::kDisks,
     .low = 0.02,
     .size = 0.03,
     .debris = 25,
     .decoys = 10,
     .floor_pairs = 10,
     .limits = kFloor},
    {.name = "dis_nobody_dark",
     .robots = 0,
     .high = 0,
     .debris = 25,
     .decoys = 10,
     .floor_pairs = 10,
     .limits = kFloor},
    {.name = "dis_nobody_jpeg",
     .robots = 0,
     .high = 0.12,
     .debris = 25,
     .decoys = 10,
     .floor_pairs = 10,
     .jpeg = 50,
     .limits = kFloor},
    {.name = "opt_jpeg", .jpeg = 75, .limits = kAll},
    {.name = "opt_jpeg_12", .high = 0.12, .jpeg = 75, .limits = kAllHonest},
    {.name = "opt_jpeg_05", .high = 0.05, .jpeg = 75, .limits = kDimJpeg},
    {.name = "opt_jpeg_half", .shown = SceneLight::kHalf, .low = 0.12, .jpeg = 75, .limits = kEdge},
    {.name = "opt_jpeg_worn", .high = 0.12, .jpeg = 50, .limits = kHard},
    {.name = "opt_gamma", .gamma = 2.2, .limits = kAllHonest},
    {.name = "opt_gamma_05", .high = 0.05, .gamma = 2.2, .limits = kAllHonest},
    {.name = "opt_gamma_half",
     .shown = SceneLight::kHalf,
     .low = 0.12,
     .gamma = 2.2,
     .limits = kEdge},
    {.name = "opt_webcam", .gamma = 2.2, .sharpened = 1, .jpeg = 75, .limits = kAll},
    {.name = "opt_webcam_12",
     .high = 0.12,
     .gamma = 2.2,
     .sharpened = 1,
     .jpeg = 75,
     .limits = kHard},
    {.name = "opt_webcam_half",
     .shown = SceneLight::kHalf,
     .low = 0.12,
     .gamma = 2.2,
     .sharpened = 1,
     .jpeg = 75,
     .limits = kEdge},
    {.name = "dis_nobody_webcam",
     .robots = 0,
     .debris = 25,
     .decoys = 10,
     .floor_pairs = 10,
     .gamma = 2.2,
     .sharpened = 1,
     .jpeg = 75,
     .limits = kFloor},
    {.name = "opt_defocus25", .blur = 2.5, .limits = kAll},
    {.name = "opt_motion10ms", .speed = 0.12, .limits = kAll},
    {.name = "opt_motion25ms", .exposure = 0.025, .brightness = 0.4, .speed = 0.12, .limits = kAll},
    {.name = "opt_noise", .read_noise = 5, .limits = kAllHonest},
    {.name = "opt_small", .rows = 480, .limits = kAll},
    {.name = "opt_vignette", .vignetting = 0.6, .limits = kAll},
    kWorst,
    with(kWorst, "worst_1080", [](SceneKind& kind) { kind.rows = 1080; }),
    with(kWorst, "worst_720_dark",
         [](SceneKind& kind) {
           kind.low = 0.05;
           kind.blur = 1.1;
         }),
    with(kWorst, "worst_disks",
         [](SceneKind& kind) {
           kind.shown = SceneLight::kDisks;
           kind.size = 0.1;
         }),
};

}  // namespace

std::span<const SceneKind> kinds() { return kKinds; }

const SceneKind& kindOf(std::string_view name) {
  for (const SceneKind& kind : kKinds) {
    if (kind.name == name) return kind;
  }
  throw std::out_of_range("no kind of pictures is named " + std::string(name));
}

}  // namespace lab::cases
