/// Paints one robot into the cells of the simulated camera.
#pragma once

#include "sim_svc/camera/camera_painter_cells.hpp"
#include "sim_svc/camera/camera_painter_ground.hpp"
#include "sim_svc/camera/camera_painter_light.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::sim::painter {

/// The arrays that robots are painted into, with one value per cell.
struct Canvas {
  const Lattice* lattice = nullptr;
  const Ground* ground = nullptr;
  const float* cap_light = nullptr;  ///< [1] projector light on the cap plane
  float* grey = nullptr;             ///< [1] reflected light
};

/// A robot at one time, with its motion in the piece of the exposure around this time.
class RobotPainter {
 public:
  /// @param duration [s] of the piece of the exposure
  RobotPainter(const PainterSettings& settings, const optics::CameraModel& model,
               const PaintedRobot& robot, double duration);

  /// All pixels that any of its shapes touch.
  [[nodiscard]] const Box& pixels() const { return pixels_; }

  void castShadow(const Canvas& canvas) const;
  void paintSides(const Canvas& canvas) const;
  void paintTop(const Canvas& canvas) const;

 private:
  /// The sides of a cell, and the motion during the piece, as vectors in the cap plane [m].
  struct Cell {
    double right_x = 0, right_y = 0;
    double down_x = 0, down_y = 0;
    double move_x = 0, move_y = 0;

    /// The squared width of an edge, averaged over all directions.
    [[nodiscard]] double meanSquare() const {
      return 0.5 * (right_x * right_x + right_y * right_y + down_x * down_x + down_y * down_y +
                    move_x * move_x + move_y * move_y);
    }
  };

  /// Columns from <= i < to of a row of cells.
  struct Span {
    int from = 0, to = 0;
  };

  /// Finds the cells of a row within a distance of a point, with a linear approximation of the
  /// lens.
  class Rows {
   public:
    Rows(const RobotPainter& painter, const Lattice& lattice, double x, double y, double z);

    /// A superset of the cells within `radius` [m] of the point.
    [[nodiscard]] Span touching(int row, double radius) const;
    /// A subset of the cells within `radius` [m] of the point; may be empty.
    [[nodiscard]] Span inside(int row, double radius) const;

   private:
    [[nodiscard]] Span within(int row, double radius) const;

    double i_ = 0, j_ = 0;             ///< [cells] the point
    double aa_ = 1, ab_ = 0, bb_ = 1;  ///< [m^2] quadratic form: squared distance from cell offsets
    double spare_ = 0;                 ///< [m] safety margin
  };

  [[nodiscard]] Cell cellAt(double x, double y) const;
  void paintTag(const Canvas& canvas) const;
  void paintDisc(const Canvas& canvas, double forward, double radius, double hidden,
                 double albedo) const;
  /// Calls row(first, count) for the cells that the robot's upright cylinder may cover as seen from
  /// a far point, except those that its own cap covers.
  template <class Row>
  void forCylinder(const Canvas& canvas, const PlaneShift& far, Row row) const;

  const PainterSettings& settings_;
  const optics::CameraModel& model_;
  PaintedRobot robot_;
  double duration_;
  PlaneShift to_projector_;
  PlaneShift to_camera_;
  double cosine_, sine_;
  double solid_ = 0;  ///< [m] distance from the axis within which only the cap is visible
  Box pixels_;
};

}  // namespace lab::sim::painter
