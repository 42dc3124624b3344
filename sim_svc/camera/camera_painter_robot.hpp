/// One robot in the cells of the simulated camera.
#pragma once

#include "sim_svc/camera/camera_painter_cells.hpp"
#include "sim_svc/camera/camera_painter_ground.hpp"
#include "sim_svc/camera/camera_painter_light.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim::painter {

/// Where robots are painted: all cells, each of these arrays.
struct Canvas {
  const Lattice* lattice = nullptr;
  const Ground* ground = nullptr;
  const float* cap_light = nullptr;  ///< [1] of the projector, on the cap plane
  float* grey = nullptr;             ///< [1] light sent back
};

/// A robot at one instant, with the movement of the piece of the exposure around it.
class RobotPainter {
 public:
  /// @param duration [s] of the piece of the exposure in which the robot moves on
  RobotPainter(const PainterSettings& settings, const optics::CameraModel& model,
               const PaintedRobot& robot, double duration);

  /// All pixels in which any of its shapes lie.
  [[nodiscard]] const Box& pixels() const { return pixels_; }

  void castShadow(const Canvas& canvas) const;
  void paintSides(const Canvas& canvas) const;
  void paintTop(const Canvas& canvas) const;

 private:
  /// A cell, and the way moved, as sides in the cap plane [m].
  struct Cell {
    double right_x = 0, right_y = 0;
    double down_x = 0, down_y = 0;
    double move_x = 0, move_y = 0;

    /// Mean over all directions of the squared width of an edge.
    [[nodiscard]] double meanSquare() const {
      return 0.5 * (right_x * right_x + right_y * right_y + down_x * down_x + down_y * down_y +
                    move_x * move_x + move_y * move_y);
    }
  };

  /// Columns from <= i < to of a row of cells.
  struct Span {
    int from = 0, to = 0;
  };

  /// Which cells of a row lie within a distance of a place, by a straight map.
  class Rows {
   public:
    Rows(const RobotPainter& painter, const Lattice& lattice, double x, double y, double z);

    /// Cells that may lie within `radius` [m] of the place, and a few more.
    [[nodiscard]] Span touching(int row, double radius) const;
    /// Cells that lie within `radius` of the place, without a few; may be empty.
    [[nodiscard]] Span inside(int row, double radius) const;

   private:
    [[nodiscard]] Span within(int row, double radius) const;

    double i_ = 0, j_ = 0;             ///< [cells] of the place
    double aa_ = 1, ab_ = 0, bb_ = 1;  ///< [m^2] squared distance by cells
    double spare_ = 0;                 ///< [m]
  };

  [[nodiscard]] Cell cellAt(double x, double y) const;
  void paintDisc(const Canvas& canvas, double forward, double radius, double hidden,
                 double albedo) const;
  /// Calls row(first, count) for the cells that the upright cylinder around the robot's axis may
  /// cover as seen from a far point, but for those that its own cap covers.
  template <class Row>
  void forCylinder(const Canvas& canvas, const PlaneShift& far, Row row) const;

  const PainterSettings& settings_;
  const optics::CameraModel& model_;
  PaintedRobot robot_;
  double duration_;
  PlaneShift to_projector_;
  PlaneShift to_camera_;
  double cosine_, sine_;
  double solid_ = 0;  ///< [m] from the axis: nothing but the cap is seen there
  Box pixels_;
};

}  // namespace lab::sim::painter
