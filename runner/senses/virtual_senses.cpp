#include "runner/senses/virtual_senses.hpp"

#include <cmath>

#include "common/math/angle.hpp"
#include "common/math/units.hpp"
#include "robot/language/formula.hpp"

namespace lab::runner {
namespace {

constexpr unsigned kAllSenses = (1U << dynamics::kSenses) - 1;
constexpr double kGradientStep = 0.01;  // [m] between the places whose light is compared

/// What the robots within a radius are, seen from one of them.
struct Neighbourhood {
  double count = 0;
  double density = 0;
  double heading_x = 0;  ///< sum of the unit vectors of relative headings
  double heading_y = 0;
  double nearest = 0;  ///< [m]
  double bearing = 0;  ///< [rad] of the nearest robot, relative
};

Neighbourhood neighbourhood(const std::vector<SensedPose>& poses, const SensedPose& self,
                            double radius) {
  Neighbourhood result;
  result.nearest = radius;
  for (const SensedPose& other : poses) {
    const double dx = other.x - self.x;
    const double dy = other.y - self.y;
    const double distance = std::hypot(dx, dy);
    if (&other == &self || distance > radius) continue;
    result.count += 1;
    result.density += 1 - distance / radius;
    result.heading_x += std::cos(other.theta - self.theta);
    result.heading_y += std::sin(other.theta - self.theta);
    if (distance <= result.nearest) {
      result.nearest = distance;
      result.bearing = wrapAngle(std::atan2(dy, dx) - self.theta);
    }
  }
  return result;
}

/// The gradient of the light [1/m], by central differences.
std::array<double, 2> gradientAt(const LightAt& light, const SensedPose& at) {
  if (!light) return {0, 0};
  const double h = kGradientStep;
  return {(light(at.x + h, at.y) - light(at.x - h, at.y)) / (2 * h),
          (light(at.x, at.y + h) - light(at.x, at.y - h)) / (2 * h)};
}

double valueOf(const SenseSpec& sense, const std::vector<SensedPose>& poses, const SensedPose& self,
               const LightAt& light) {
  switch (sense.kind) {
    case SenseKind::kNeighbours:
      return neighbourhood(poses, self, sense.radius).count;
    case SenseKind::kDensity:
      return neighbourhood(poses, self, sense.radius).density;
    case SenseKind::kMeanHeading: {
      const Neighbourhood near = neighbourhood(poses, self, sense.radius);
      return near.count == 0 ? 0 : std::atan2(near.heading_y, near.heading_x);
    }
    case SenseKind::kNearestDistance:
      return neighbourhood(poses, self, sense.radius).nearest / units::kCentimetre;
    case SenseKind::kNearestBearing:
      return neighbourhood(poses, self, sense.radius).bearing;
    case SenseKind::kPlaceDistance:
      return std::hypot(sense.x - self.x, sense.y - self.y) / units::kCentimetre;
    case SenseKind::kPlaceBearing:
      return wrapAngle(std::atan2(sense.y - self.y, sense.x - self.x) - self.theta);
    case SenseKind::kGradient: {
      const auto [gx, gy] = gradientAt(light, self);
      return std::hypot(gx, gy) * units::kCentimetre;
    }
    case SenseKind::kGradientBearing: {
      const auto [gx, gy] = gradientAt(light, self);
      return gx == 0 && gy == 0 ? 0 : wrapAngle(std::atan2(gy, gx) - self.theta);
    }
    case SenseKind::kExpression:
      break;
  }
  return 0;
}

}  // namespace

std::vector<SenseValues> virtualSenses(const std::vector<SenseSpec>& senses,
                                       const std::vector<SensedPose>& poses, const LightAt& light) {
  std::vector<SenseValues> all(poses.size(), SenseValues{});
  for (std::size_t robot = 0; robot < poses.size(); ++robot) {
    for (const SenseSpec& sense : senses) {
      if (sense.kind == SenseKind::kExpression) continue;
      all[robot][static_cast<std::size_t>(sense.index)] =
          valueOf(sense, poses, poses[robot], light);
    }
  }
  for (const SenseSpec& sense : senses) {
    if (sense.kind != SenseKind::kExpression) continue;
    const language::Formula formula = language::Formula::ofSenses(sense.value, kAllSenses);
    for (SenseValues& values : all) {
      const double value = formula(0, values);
      values[static_cast<std::size_t>(sense.index)] = std::isfinite(value) ? value : 0;
    }
  }
  return all;
}

}  // namespace lab::runner
