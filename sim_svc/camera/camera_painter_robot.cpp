#include "sim_svc/camera/camera_painter_robot.hpp"

#include <cmath>
#include <vector>

#include "light/optics/tag_pattern.hpp"

namespace lab::sim::painter {
namespace {

constexpr double kPenumbra = 0.001;  // [m] width of a shadow's edge on the floor
constexpr float kTiny = 1e-12F;      // [m^2]

/// A disc on a plane above the floor.
struct Disc {
  float scale, x0, y0;  // maps a floor point to the position relative to the disc's centre
  float radius;         // [m] corrected for the blurred edge
  float right_x, right_y, down_x, down_y, move_x, move_y;  // [m] sides of the cell, and the motion
  float albedo, ambient;
};

/// An upright cylinder as seen from a far point.
struct Cylinder {
  float x, y;                 // [m] axis
  float scale, far_x, far_y;  // maps a floor point to the top plane, towards the far point
  float radius;               // [m]
  float per_width;            // [1/m]
};

struct Side {
  float albedo, ambient;
  float light_x, light_y;  // [1] horizontal direction to the projector per height
};

inline float clamped(float value) {
  value = value > 0.0F ? value : 0.0F;
  return value < 1.0F ? value : 1.0F;
}

inline float coverOfCylinder(const Cylinder& c, float fx, float fy, float& gx, float& gy) {
  gx = (c.scale - 1.0F) * fx + c.far_x;
  gy = (c.scale - 1.0F) * fy + c.far_y;
  const float px = fx - c.x;
  const float py = fy - c.y;
  const float nearest = clamped(-(px * gx + py * gy) / (gx * gx + gy * gy + kTiny));
  const float dx = px + nearest * gx;
  const float dy = py + nearest * gy;
  return clamped((c.radius - __builtin_sqrtf(dx * dx + dy * dy)) * c.per_width + 0.5F);
}

LAB_TARGET_CLONES
void shadowRow(Cylinder cylinder, float ambient, const float* __restrict fx,
               const float* __restrict fy, const float* __restrict albedo, float* __restrict grey,
               int count) {
  for (int i = 0; i < count; ++i) {
    float gx = 0;
    float gy = 0;
    const float dark = ambient * albedo[i];
    grey[i] = dark + (1.0F - coverOfCylinder(cylinder, fx[i], fy[i], gx, gy)) * (grey[i] - dark);
  }
}

LAB_TARGET_CLONES
void sideRow(Cylinder cylinder, Side side, const float* __restrict fx, const float* __restrict fy,
             const float* __restrict light, float* __restrict grey, int count) {
  for (int i = 0; i < count; ++i) {
    float gx = 0;
    float gy = 0;
    const float cover = coverOfCylinder(cylinder, fx[i], fy[i], gx, gy);
    // The point where the line of sight, coming from the top plane, meets the side.
    const float px = fx[i] + gx - cylinder.x;
    const float py = fy[i] + gy - cylinder.y;
    const float a = gx * gx + gy * gy + kTiny;
    const float b = px * gx + py * gy;
    const float c = px * px + py * py - cylinder.radius * cylinder.radius;
    float root = b * b - a * c;
    root = root > 0.0F ? root : 0.0F;
    const float along = (b - __builtin_sqrtf(root)) / a;
    const float facing =
        ((px - along * gx) * side.light_x + (py - along * gy) * side.light_y) / cylinder.radius;
    const float value = side.albedo * (side.ambient + clamped(4.0F * facing) * light[i]);
    grey[i] += cover * (value - grey[i]);
  }
}

LAB_TARGET_CLONES
void discRow(Disc disc, const float* __restrict fx, const float* __restrict fy,
             const float* __restrict light, float* __restrict grey, int count) {
  for (int i = 0; i < count; ++i) {
    const float dx = disc.scale * fx[i] + disc.x0;
    const float dy = disc.scale * fy[i] + disc.y0;
    const float r2 = dx * dx + dy * dy + kTiny;
    const float r = __builtin_sqrtf(r2);
    const float per_r = 1.0F / r;
    const float nx = dx * per_r;
    const float ny = dy * per_r;
    const float cover =
        coverOf(disc.radius - r, __builtin_fabsf(disc.right_x * nx + disc.right_y * ny),
                __builtin_fabsf(disc.down_x * nx + disc.down_y * ny),
                __builtin_fabsf(disc.move_x * nx + disc.move_y * ny));
    grey[i] += cover * (disc.albedo * (disc.ambient + light[i]) - grey[i]);
  }
}

LAB_TARGET_CLONES
void solidRow(float albedo, float ambient, const float* __restrict light, float* __restrict grey,
              int count) {
  for (int i = 0; i < count; ++i) grey[i] = albedo * (ambient + light[i]);
}

Box joined(const Box& a, const Box& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

}  // namespace

RobotPainter::RobotPainter(const PainterSettings& settings, const optics::CameraModel& model,
                           const PaintedRobot& robot, double duration)
    : settings_(settings),
      model_(model),
      robot_(robot),
      duration_(duration),
      to_projector_(PlaneShift::towards(settings.projector, settings.cap.height)),
      to_camera_(PlaneShift::towards(model.centre(), settings.cap.height)),
      cosine_(std::cos(robot.theta)),
      sine_(std::sin(robot.theta)) {
  const double moved = std::hypot(robot.vx, robot.vy) * duration;
  const double radius =
      std::max(settings.cap.robot_radius, settings.cap.cap_radius) + kPenumbra + moved;
  solid_ = settings.cap.cap_radius - moved;
  const double height = settings.cap.height;
  // The far end of the shadow: the top, projected from the projector onto the floor.
  const double grown = 1 / to_projector_.scale;
  pixels_ = joined(joined(pixelsAround(model, robot.x, robot.y, 0, radius),
                          pixelsAround(model, robot.x, robot.y, height, radius)),
                   pixelsAround(model, grown * (robot.x - to_projector_.x0),
                                grown * (robot.y - to_projector_.y0), 0, grown * radius));
}

RobotPainter::Cell RobotPainter::cellAt(double x, double y) const {
  const optics::PlaneScale s = model_.scaleAt({x, y}, settings_.cap.height);
  const double half = 0.5 / (s.ux * s.vy - s.uy * s.vx);
  Cell cell;
  cell.right_x = half * s.vy;
  cell.right_y = -half * s.vx;
  cell.down_x = -half * s.uy;
  cell.down_y = half * s.ux;
  cell.move_x = (robot_.vx - robot_.omega * (y - robot_.y)) * duration_;
  cell.move_y = (robot_.vy + robot_.omega * (x - robot_.x)) * duration_;
  return cell;
}

RobotPainter::Rows::Rows(const RobotPainter& painter, const Lattice& lattice, double x, double y,
                         double z) {
  constexpr double kSpareCells = 0.5;   // for rounding
  constexpr double kSpareShare = 0.02;  // for the nonlinearity of the lens
  const Cell cell = painter.cellAt(x, y);
  const optics::Pixel at = painter.model_.project(x, y, z);
  i_ = 2 * (at.x + lattice.margin) + 0.5;
  j_ = 2 * (at.y + lattice.margin) + 0.5;
  aa_ = cell.right_x * cell.right_x + cell.right_y * cell.right_y;
  ab_ = cell.right_x * cell.down_x + cell.right_y * cell.down_y;
  bb_ = cell.down_x * cell.down_x + cell.down_y * cell.down_y;
  // Includes half the width of an edge: three boxes whose squares add up to at most twice the mean
  // square.
  spare_ = kSpareCells * std::sqrt(std::max(aa_, bb_)) + 0.5 * std::sqrt(6 * cell.meanSquare()) +
           kSpareShare * painter.settings_.cap.robot_radius;
}

RobotPainter::Span RobotPainter::Rows::within(int row, double radius) const {
  const double down = row - j_;
  const double root = ab_ * down * (ab_ * down) - aa_ * (bb_ * down * down - radius * radius);
  if (radius <= 0 || root <= 0) return {};
  const double half = std::sqrt(root) / aa_;
  const double middle = i_ - ab_ * down / aa_;
  return {static_cast<int>(std::ceil(middle - half)),
          static_cast<int>(std::floor(middle + half)) + 1};
}

RobotPainter::Span RobotPainter::Rows::touching(int row, double radius) const {
  return within(row, radius + spare_);
}

RobotPainter::Span RobotPainter::Rows::inside(int row, double radius) const {
  return within(row, radius - spare_);
}

template <class Row>
void RobotPainter::forCylinder(const Canvas& canvas, const PlaneShift& far, Row row) const {
  const Lattice& lattice = *canvas.lattice;
  const double radius = settings_.cap.robot_radius + kPenumbra;
  // The projection of the cylinder onto the floor, approximated by the discs of foot, top and some
  // heights between. They are so close that their union nearly fills the hull.
  std::vector<Rows> hull;
  double largest = 0;
  const double length =
      std::hypot(far.x0 + (far.scale - 1) * robot_.x, far.y0 + (far.scale - 1) * robot_.y);
  const int steps = 1 + static_cast<int>(3 * length / (far.scale * radius));
  for (int step = 0; step <= steps; ++step) {
    const double up = static_cast<double>(step) / steps;
    const double scale = 1 + up * (far.scale - 1);
    const double x = (robot_.x - up * far.x0) / scale;
    const double y = (robot_.y - up * far.y0) / scale;
    hull.emplace_back(*this, lattice, x, y, 0);
    largest = std::max(largest, radius / scale);
  }
  const Box cells = lattice.cells(pixels_).within(lattice.all());
  const Rows cap(*this, lattice, robot_.x, robot_.y, settings_.cap.height);
  for (int j = cells.y0; j < cells.y1; ++j) {
    Span all{cells.x1, cells.x0};
    for (const Rows& disc : hull) {
      const Span one = disc.touching(j, largest);
      if (one.from >= one.to) continue;
      all = {std::min(all.from, one.from), std::max(all.to, one.to)};
    }
    all = {std::max(all.from, cells.x0), std::min(all.to, cells.x1)};
    const Span hidden = cap.inside(j, solid_);
    const auto call = [&](int from, int to) {
      if (from < to) row(lattice.at(from, j), to - from);
    };
    if (hidden.from >= hidden.to) {
      call(all.from, all.to);
    } else {
      call(all.from, std::min(hidden.from, all.to));
      call(std::max(hidden.to, all.from), all.to);
    }
  }
}

void RobotPainter::castShadow(const Canvas& canvas) const {
  const double edge = std::sqrt(cellAt(robot_.x, robot_.y).meanSquare() + kPenumbra * kPenumbra);
  const Cylinder cylinder{static_cast<float>(robot_.x),
                          static_cast<float>(robot_.y),
                          static_cast<float>(to_projector_.scale),
                          static_cast<float>(to_projector_.x0),
                          static_cast<float>(to_projector_.y0),
                          static_cast<float>(settings_.cap.robot_radius),
                          static_cast<float>(1 / edge)};
  const auto ambient = static_cast<float>(settings_.ambient);
  forCylinder(canvas, to_projector_, [&](std::size_t at, int count) {
    shadowRow(cylinder, ambient, &canvas.ground->x[at], &canvas.ground->y[at],
              &canvas.ground->albedo[at], canvas.grey + at, count);
  });
}

void RobotPainter::paintSides(const Canvas& canvas) const {
  const double edge = std::sqrt(cellAt(robot_.x, robot_.y).meanSquare());
  const Cylinder cylinder{
      static_cast<float>(robot_.x),         static_cast<float>(robot_.y),
      static_cast<float>(to_camera_.scale), static_cast<float>(to_camera_.x0),
      static_cast<float>(to_camera_.y0),    static_cast<float>(settings_.cap.robot_radius),
      static_cast<float>(1 / edge)};
  const double up = settings_.projector[2] - settings_.cap.height;
  const Side side{static_cast<float>(settings_.albedos.body), static_cast<float>(settings_.ambient),
                  static_cast<float>((settings_.projector[0] - robot_.x) / up),
                  static_cast<float>((settings_.projector[1] - robot_.y) / up)};
  forCylinder(canvas, to_camera_, [&](std::size_t at, int count) {
    sideRow(cylinder, side, &canvas.ground->x[at], &canvas.ground->y[at], canvas.cap_light + at,
            canvas.grey + at, count);
  });
}

/// Paints a disc on the cap, except within `hidden` [m] of its centre, where another disc will be
/// painted over it.
void RobotPainter::paintDisc(const Canvas& canvas, double forward, double radius, double hidden,
                             double albedo) const {
  const double x = robot_.x + forward * cosine_;
  const double y = robot_.y + forward * sine_;
  const Cell cell = cellAt(x, y);
  const double mean2 = cell.meanSquare();
  // An edge blurred evenly to both sides would increase the area; correct the radius.
  const double inner = std::sqrt(std::max(radius * radius - mean2 / 12, 0.0));
  const Disc disc{static_cast<float>(to_camera_.scale),
                  static_cast<float>(to_camera_.x0 - x),
                  static_cast<float>(to_camera_.y0 - y),
                  static_cast<float>(inner),
                  static_cast<float>(cell.right_x),
                  static_cast<float>(cell.right_y),
                  static_cast<float>(cell.down_x),
                  static_cast<float>(cell.down_y),
                  static_cast<float>(cell.move_x),
                  static_cast<float>(cell.move_y),
                  static_cast<float>(albedo),
                  static_cast<float>(settings_.ambient)};
  const Lattice& lattice = *canvas.lattice;
  const Box cells =
      lattice.cells(pixelsAround(model_, x, y, settings_.cap.height, radius + 2 * std::sqrt(mean2)))
          .within(lattice.all());
  const Rows rows(*this, lattice, x, y, settings_.cap.height);
  for (int j = cells.y0; j < cells.y1; ++j) {
    const auto part = [&](int from, int to, bool edge) {
      from = std::max(from, 0);
      to = std::min(to, lattice.columns());
      if (from >= to) return;
      const std::size_t at = lattice.at(from, j);
      if (edge) {
        discRow(disc, &canvas.ground->x[at], &canvas.ground->y[at], canvas.cap_light + at,
                canvas.grey + at, to - from);
      } else {
        solidRow(disc.albedo, disc.ambient, canvas.cap_light + at, canvas.grey + at, to - from);
      }
    };
    // Round up to whole vectors; cells further out are exactly 0.
    const auto whole = [](int count) { return (count + 7) / 8 * 8; };
    const Span all = rows.touching(j, radius);
    const Span solid = rows.inside(j, hidden > 0 ? hidden : radius);
    if (solid.from >= solid.to) {
      part(all.from, all.from + whole(all.to - all.from), true);
      continue;
    }
    part(solid.from - whole(solid.from - all.from), solid.from, true);
    if (!(hidden > 0)) part(solid.from, solid.to, false);
    part(solid.to, solid.to + whole(all.to - solid.to), true);
  }
}

/// Paints the tag by the mean of points in each cell of the lattice, which is much smaller than a
/// cell of the tag.
void RobotPainter::paintTag(const Canvas& canvas) const {
  constexpr int kPoints = 4;  // along each side of a cell
  const optics::TagPattern pattern = optics::TagFamily(settings_.tag_family).pattern(robot_.tag);
  const double per_cell = 2 * pattern.half_square / settings_.tag_size;  // [1/m]
  const double middle = pattern.cells / 2.0;
  const double radius = middle / per_cell * 1.4143;
  const Cell cell = cellAt(robot_.x, robot_.y);
  const Lattice& lattice = *canvas.lattice;
  const Box cells =
      lattice.cells(pixelsAround(model_, robot_.x, robot_.y, settings_.cap.height, radius))
          .within(lattice.all());
  const auto at_point = [&](double x, double y, double& sum) {
    const double column = (cosine_ * x + sine_ * y) * per_cell + middle;
    const double row = middle - (-sine_ * x + cosine_ * y) * per_cell;
    if (column < 0 || row < 0 || column >= pattern.cells || row >= pattern.cells) return false;
    const bool dark = pattern.at(static_cast<int>(column), static_cast<int>(row)) > 0.5F;
    sum += dark ? settings_.albedos.circle : settings_.albedos.cap;
    return true;
  };
  for (int j = cells.y0; j < cells.y1; ++j) {
    for (int i = cells.x0; i < cells.x1; ++i) {
      const std::size_t at = lattice.at(i, j);
      const double x =
          to_camera_.scale * static_cast<double>(canvas.ground->x[at]) + to_camera_.x0 - robot_.x;
      const double y =
          to_camera_.scale * static_cast<double>(canvas.ground->y[at]) + to_camera_.y0 - robot_.y;
      if (x * x + y * y > radius * radius) continue;
      double sum = 0;
      int inside = 0;
      for (int k = 0; k < kPoints * kPoints; ++k) {
        const double right = (k % kPoints + 0.5) / kPoints - 0.5;
        const double down = (k / kPoints + 0.5) / kPoints - 0.5;
        // Each point at another time of the exposure.
        const double time = (k * 7 % (kPoints * kPoints) + 0.5) / (kPoints * kPoints) - 0.5;
        if (at_point(x + right * cell.right_x + down * cell.down_x - time * cell.move_x,
                     y + right * cell.right_y + down * cell.down_y - time * cell.move_y, sum)) {
          ++inside;
        }
      }
      if (inside == 0) continue;
      const double share = static_cast<double>(inside) / (kPoints * kPoints);
      const auto light = settings_.ambient + static_cast<double>(canvas.cap_light[at]);
      float& grey = canvas.grey[at];
      grey += static_cast<float>(share * (sum / inside * light - static_cast<double>(grey)));
    }
  }
}

void RobotPainter::paintTop(const Canvas& canvas) const {
  constexpr double kHole = 0.0325;       // [m] distance before and behind the axis
  constexpr double kHoleRadius = 0.002;  // [m]
  const optics::CapGeometry& cap = settings_.cap;
  const Albedos& albedos = settings_.albedos;
  paintDisc(canvas, 0, cap.robot_radius, solid_, albedos.body);
  const bool black = settings_.top == RobotTop::kSpot && settings_.bright_spot;
  paintDisc(canvas, 0, cap.cap_radius, 0, black ? albedos.circle : albedos.cap);
  if (settings_.top == RobotTop::kTag) return paintTag(canvas);
  if (settings_.top == RobotTop::kSpot) {
    paintDisc(canvas, 0, settings_.spot_radius, 0, black ? albedos.cap : albedos.circle);
    return;
  }
  paintDisc(canvas, cap.big_offset, cap.big_radius, 0, albedos.circle);
  paintDisc(canvas, cap.small_offset, cap.small_radius, 0, albedos.circle);
  paintDisc(canvas, kHole, kHoleRadius, 0, albedos.hole);
  paintDisc(canvas, -kHole, kHoleRadius, 0, albedos.hole);
}

}  // namespace lab::sim::painter
