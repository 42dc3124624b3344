#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "analyzer/report/figures/figure_crowd.hpp"
#include "analyzer/report/figures/figure_files.hpp"
#include "common/math/angle.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

using units::kCm;

using Rgb = std::array<double, 3>;

// Okabe and Ito, without black: colours of the largest clusters.
constexpr std::array<Rgb, 7> kClusterColours{{{0, 114, 178},
                                              {213, 94, 0},
                                              {0, 158, 115},
                                              {204, 121, 167},
                                              {230, 159, 0},
                                              {86, 180, 233},
                                              {240, 228, 66}}};
constexpr Rgb kAlone{216, 216, 216};

/// Outline of the arena with equal scales, in cm, without axes.
std::string arenaFrame(const RunRecord& record) {
  const Experiment& experiment = record.experimentOrDefault();
  return fmt::format(
      "set size ratio -1\nset border 31\nunset xtics\nunset ytics\nset xrange [0:{:.6g}]\n"
      "set yrange [0:{:.6g}]\n",
      experiment.arena_width * kCm, experiment.arena_height * kCm);
}

}  // namespace

FigureScript crowdArenaFigure(const RunRecord& record) {
  FigureScript script;
  script.figure.name = "crowd_arena";
  script.figure.title = "Robots by cluster, local density and heading";
  const collective::CrowdPicture& picture = record.crowd_picture;
  const double radius = 0.5 * record.experimentOrDefault().hardware.diameter * kCm;
  CsvText csv("robot,x_cm,y_cm,theta_rad,cluster,cluster_size,local_density,hexatic_order");
  DataBlock robots("robots");
  DataBlock headings("headings");
  bool has_headings = false;
  for (std::size_t i = 0; i < picture.robots.size(); ++i) {
    const collective::CrowdRobot& robot = picture.robots[i];
    const double x = robot.x * kCm;
    const double y = robot.y * kCm;
    const int cluster = picture.observation.clusters[i];
    const double density = picture.observation.densities[i];
    const double theta = wrapAngle(robot.theta);
    csv.row(robot.id, x, y, theta, cluster, picture.observation.cluster_sizes[i], density,
            picture.observation.hexatics[i]);
    const Rgb colour =
        cluster == 0
            ? kAlone
            : kClusterColours.at(static_cast<std::size_t>(cluster - 1) % kClusterColours.size());
    robots.row(x, y, radius, colour[0], colour[1], colour[2], density);
    if (!std::isfinite(theta)) continue;
    has_headings = true;
    headings.row(x, y, radius, theta / std::numbers::pi * 180, radius * std::cos(theta),
                 radius * std::sin(theta));
  }
  script.figure.csv = csv.text();
  const std::string frame = arenaFrame(record);
  script.script =
      robots.text() + (has_headings ? headings.text() : "") +
      style::preamble(script.figure.name, 1200, 400, style::kPage_cm) + frame +
      fmt::format(
          "set multiplot layout 1,{} margins screen 0.01,0.97,0.12,0.90 spacing screen 0.06\n"
          "unset key\nset colorbox horizontal user origin graph 0.15,graph -0.11 size graph "
          "0.7,graph 0.04\nset title 'cluster' offset 0,-0.6\nset style fill solid 1 border lc rgb "
          "'#404040'\n"
          "plot $robots using 1:2:3:(65536*$4+256*$5+$6) with circles lc rgb variable notitle\n"
          "set title 'local packing fraction' offset 0,-0.6\nset cbrange [0:0.91]\nset cbtics 0.3\n"
          "set palette defined (0 '#440154', 1 '#414487', 2 '#2a788e', 3 '#22a884', 4 '#7ad151', "
          "5 '#fde725')\n"
          "plot $robots using 1:2:3:7 with circles lc palette notitle\n",
          has_headings ? 3 : 2);
  if (has_headings) {
    script.script +=
        "set title 'heading (°)' offset 0,-0.6\nset cbrange [-180:180]\nset cbtics 90\n"
        "set palette model HSV defined (0 0 0.6 0.85, 1 1 0.6 0.85)\n"
        "plot $headings using 1:2:3:4 with circles lc palette notitle, "
        "$headings using 1:2:5:6 with vectors nohead lw 1 lc rgb 'black' notitle\n";
  }
  script.script += "unset multiplot\nset palette model RGB\n";
  script.figure.caption = fmt::format(
      "All robots after {}. Robots closer than {} cm, centre to centre, belong to a cluster; grey "
      "ones are alone. The local packing fraction is the area of a robot over that of its Voronoi "
      "cell, which ends at the walls.",
      durationText(std::max(0.0, picture.time)),
      shortText(kCm * (record.experimentOrDefault().analysis.cluster_distance > 0
                           ? record.experimentOrDefault().analysis.cluster_distance
                           : 1.1 * record.experimentOrDefault().hardware.diameter)));
  return script;
}

FigureScript crowdMapFigure(const RunRecord& record) {
  FigureScript script;
  script.figure.name = "crowd_map";
  script.figure.title = "Density and current";
  const collective::CrowdMap& map = record.crowds.front().map;
  CsvText csv(
      "x_cm,y_cm,density_per_m2,standard_error_per_m2,current_x_per_m_s,standard_error_x_per_m_s,"
      "current_y_per_m_s,standard_error_y_per_m_s");
  DataBlock cells("cells");
  double strongest = 0;
  std::size_t number = 0;
  for (const collective::MapCell& cell : map.cells) {
    csv.row(cell.x * kCm, cell.y * kCm, cell.density.value, cell.density.sigma,
            cell.current_x.value, cell.current_x.sigma, cell.current_y.value, cell.current_y.sigma);
    cells.row(cell.x * kCm, cell.y * kCm, cell.density.value);
    if (++number % map.columns == 0) cells.blank();
    strongest = std::max(strongest, std::hypot(cell.current_x.value, cell.current_y.value));
  }
  if (map.cells.empty()) {
    script.figure.sentence = "No map: nothing was observed.";
    return script;
  }
  script.figure.csv = csv.text();
  DataBlock arrows("arrows");
  const double longest = 1.4 * std::min(map.cell_width, map.cell_height) * kCm;
  for (const collective::MapCell& cell : map.cells) {
    const double x = cell.current_x.value;
    const double y = cell.current_y.value;
    // Only what is significant: two standard errors.
    const double sigma = std::hypot(cell.current_x.sigma, cell.current_y.sigma);
    if (!(std::hypot(x, y) > 2 * sigma)) continue;
    arrows.row(cell.x * kCm - 0.5 * longest * x / strongest,
               cell.y * kCm - 0.5 * longest * y / strongest, longest * x / strongest,
               longest * y / strongest);
  }
  arrows.row(units::kNan, units::kNan, 0.0, 0.0);
  script.script =
      cells.text() + arrows.text() + style::preamble(script.figure.name, 760, 560) +
      arenaFrame(record) +
      "set palette defined (0 '#ffffff', 1 '#c6dbef', 2 '#6baed6', 3 '#2171b5', 4 '#08306b')\n"
      "set cbrange [0:*]\nset cblabel 'density (robots/m²)'\n"
      "plot $cells using 1:2:3 with image notitle, $arrows using 1:2:3:4 with vectors head "
      "filled size 0.9,20 lw 1 lc rgb '#D55E00' notitle\n";
  script.figure.caption = fmt::format(
      "Density of all robots in cells of {} x {} cm, and current: density times mean velocity, "
      "where it differs from 0 by more than two standard errors. The longest arrow is {} per m and "
      "s.",
      shortText(map.cell_width * kCm), shortText(map.cell_height * kCm), shortText(strongest));
  return script;
}

}  // namespace lab::report
