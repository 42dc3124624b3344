/// The commands `calibrate camera|projector|light|motors`. All throw UserError for what the user
/// can correct.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment/command_line_sources.hpp"
#include "runner/command_line/command_main.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {

struct CalibrateOptions {
  std::filesystem::path file;
  std::filesystem::path out = "runs";  ///< where run folders are made
  std::filesystem::path programs;      ///< folder of the services' programs
  std::vector<std::string> set;        ///< key=value
  CommandLineSources sources;
  std::vector<std::int32_t> robots;  ///< empty: all
  bool virtual_time = false;
};
ExitCode calibrateMotors(const CalibrateOptions& options);

struct CalibrateCameraOptions {
  /// Film of robots that drive about, or an experiment file (.toml) whose lab is filmed; or empty.
  std::string source;
  std::string corners;                ///< [px] "u,v u,v u,v u,v" (docs/calibration.md)
  std::string board = "9x6,2.8";      ///< columns x rows of discs, spacing in cm
  std::string board_pictures;         ///< of the board in several poses, empty: none
  std::filesystem::path print_board;  ///< only draws the board, empty: no
  std::filesystem::path out = "camera.json";
  std::string arena_cm = "120x90";
  std::string origin_cm = "0,0";  ///< place of the first corner in the arena
  std::string camera;             ///< name of one of several cameras of an experiment
  // The robots' caps, optics::CapGeometry:
  double robot_radius_cm = 3.75;
  double cap_radius_cm = 3.6;
  double cap_height_cm = 5;
  double big_radius_cm = 0.9;
  double small_radius_cm = 0.55;
  double spacing_cm = 3.6;                 ///< between the circles of a cap
  std::optional<double> big_offset_cm;     ///< from the axis, empty: half the spacing
  std::filesystem::path print_caps;        ///< only draws the caps, empty: no
  double corner_px = 0.5;                  ///< how well the corners are marked, along each axis
  std::optional<double> camera_height_cm;  ///< above the floor, known to 1 cm
  bool k3 = false;
  bool force = false;
  // Of a lab that is filmed:
  std::filesystem::path runs = "runs";  ///< where run folders are made
  std::filesystem::path programs;       ///< folder of the services' programs
  std::vector<std::string> set;         ///< key=value
  CommandLineSources sources;
  double film_s = 60;  ///< [s]
  bool virtual_time = false;
};
ExitCode calibrateCamera(const CalibrateCameraOptions& options);

struct CalibrateProjectorOptions {
  std::filesystem::path file;
  std::filesystem::path out = "projector.json";
  std::filesystem::path runs = "runs";  ///< where run folders are made
  std::filesystem::path programs;       ///< folder of the services' programs
  std::vector<std::string> set;         ///< key=value
  CommandLineSources sources;
  std::optional<double> surface_cm;  ///< above the floor, of what the light falls on
  std::string projector_cm;          ///< "x,y,z" of its lens, empty: not known
  std::string resolution;            ///< "1920x1080" of a display, empty: headless
  std::int64_t frames = 4;           ///< of the camera, for each pattern
  bool virtual_time = false;
  bool force = false;
};
ExitCode calibrateProjector(const CalibrateProjectorOptions& options);

struct CalibrateLightOptions {
  std::filesystem::path file;
  std::filesystem::path out = "light.json";
  std::filesystem::path runs = "runs";  ///< where run folders are made
  std::filesystem::path programs;       ///< folder of the services' programs
  std::vector<std::string> set;         ///< key=value
  CommandLineSources sources;
  int rounds = 6;              ///< staircases, at different places
  std::optional<bool> camera;  ///< looks too; not given: where it is the tracker
  bool virtual_time = false;
  bool force = false;
};
ExitCode calibrateLight(const CalibrateLightOptions& options);

/// The command line of `calibrate` with its four parts.
/// @param programs folder of the services' programs
void addCalibrate(CLI::App& app, Chosen& chosen, const std::filesystem::path& programs);

}  // namespace lab::runner
