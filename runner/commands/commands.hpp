/// The commands of `lab`, one function each, as main() finds them on the command line. All throw
/// UserError for what the user can mend.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/command_line/exit_code.hpp"

namespace lab::runner {

struct RunOptions {
  std::filesystem::path file;
  std::filesystem::path out = "runs";  ///< where run folders are made
  std::filesystem::path programs;      ///< folder of the services' programs
  std::vector<std::string> set;        ///< key=value
  std::optional<std::uint64_t> seed;
  bool virtual_time = false;
  bool report = true;
  std::optional<bool> web;            ///< a page in a browser, not given: as wantsDashboard() says
  std::filesystem::path web_address;  ///< file for its address too, empty: none
};
ExitCode run(const RunOptions& options);

ExitCode check(const std::filesystem::path& file, const std::vector<std::string>& set);

struct PreviewOptions {
  std::filesystem::path file;
  std::filesystem::path out = ".";  ///< folder of the pictures
  std::vector<std::string> set;     ///< key=value
};
ExitCode preview(const PreviewOptions& options);

struct AnalyzeOptions {
  std::filesystem::path input;  ///< folder of a run, log, or file of poses (.csv)
  std::optional<std::filesystem::path> out;
  bool figures = true;
  bool stitch = true;     ///< join the motion around reversals
  bool bootstrap = true;  ///< fits of the exact law, whose intervals need simulated films
  /// Of a file of poses alone:
  std::string program;             ///< model that all robots ran, empty: not known
  std::vector<std::string> set;    ///< key=value: its parameters
  std::optional<double> scale_cm;  ///< one unit of its columns x and y [cm]
  std::optional<double> fps;       ///< where it has no times [1/s]
};
ExitCode analyze(const AnalyzeOptions& options);

struct TheoryOptions {
  std::string program;            ///< abp, noisy_abp, bp, rtp
  std::vector<std::string> set;   ///< key=value: its parameters, as in experiment files
  std::string lags;               ///< [s] separated by commas, empty: 0.01 to 1000
  double exposure_ms = 0;         ///< of a frame
  double noise_cm = 0;            ///< localisation noise per axis
  double noise_deg = 0;           ///< of the heading
  std::optional<double> phase_s;  ///< from a window's begin to the next draw
  std::optional<int> phases;      ///< frames fall on so many phases of the hold
  std::string turning_deg;        ///< LOW,HIGH of an RTP's turning angles, empty: -180,180
  bool kurtosis = false;          ///< one more column (BP)
};
ExitCode theory(const TheoryOptions& options);

struct ReproduceOptions {
  std::filesystem::path out = "reproduction";
  double hours = 1;  ///< of each film but the paper's short one
  std::uint64_t seed = 1;
  std::string panels;           ///< "2b,3d"; empty: all
  int ensemble = 1;             ///< films of each set
  std::string through = "sim";  ///< or "firmware": simulated chips
  int jobs = 0;                 ///< films at a time; 0: as many as there are cores
  bool bootstrap = true;        ///< fits of the exact law
  bool keep_logs = false;
  bool force = false;  ///< replaces what is in the folder
};
ExitCode reproduce(const ReproduceOptions& options);

struct TrackOptions {
  std::string source;                 ///< a folder or pattern of pictures, or a movie
  std::filesystem::path calibration;  ///< of the camera
  std::filesystem::path out;          ///< the file of poses
  std::filesystem::path overlay;      ///< picture, movie or folder with what was found; empty: none
  std::int64_t every = 1;             ///< only each so many-th frame
  double fps = 0;                     ///< [1/s] of pictures without times, 0: 30, and it is said
  std::size_t robots = 0;             ///< how many there are at most, 0: not known
  bool force = false;                 ///< replaces files that are there
};
ExitCode track(const TrackOptions& options);

struct CalibrateOptions {
  std::filesystem::path file;
  std::filesystem::path out = "runs";  ///< where run folders are made
  std::filesystem::path programs;      ///< folder of the services' programs
  std::vector<std::string> set;        ///< key=value
  std::vector<std::int32_t> robots;    ///< empty: all
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
  double film_s = 60;                   ///< [s]
  bool virtual_time = false;
};
ExitCode calibrateCamera(const CalibrateCameraOptions& options);

struct CalibrateProjectorOptions {
  std::filesystem::path file;
  std::filesystem::path out = "projector.json";
  std::filesystem::path runs = "runs";  ///< where run folders are made
  std::filesystem::path programs;       ///< folder of the services' programs
  std::vector<std::string> set;         ///< key=value
  std::optional<double> surface_cm;     ///< above the floor, of what the light falls on
  std::string projector_cm;             ///< "x,y,z" of its lens, empty: not known
  std::string resolution;               ///< "1920x1080" of a display, empty: headless
  std::int64_t frames = 4;              ///< of the camera, for each pattern
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
  int rounds = 6;                       ///< staircases, at different places
  std::optional<bool> camera;           ///< looks too; not given: where it is the tracker
  bool virtual_time = false;
  bool force = false;
};
ExitCode calibrateLight(const CalibrateLightOptions& options);

struct ReplayOptions {
  std::filesystem::path log;  ///< or the folder of a run
  double from = 0;            ///< [s] since the log's first event
  std::optional<double> to;   ///< [s]
  double speed = 1;           ///< log seconds a second
  bool loop = false;
  std::vector<std::string> channels;  ///< empty: all
  int port = 0;                       ///< 0: a free one
  bool web = false;                   ///< on a page in a browser
  std::filesystem::path programs;     ///< folder of the page's program
};
ExitCode replay(const ReplayOptions& options);

struct LightOptions {
  std::string lab;                  ///< empty: the only one
  std::vector<std::string> layers;  ///< as in experiment files, or one number: uniform
  bool release = false;
  double ramp = 0;             ///< [s]
  std::optional<double> hold;  ///< [s], until released when not given
};
ExitCode light(const LightOptions& options);

struct StopOptions {
  std::string lab;     ///< empty: every lab
  bool clear = false;  ///< release the latch instead
};
ExitCode stop(const StopOptions& options);

/// What is wanted of a running experiment or of a log that is played.
struct RequestOptions {
  std::string lab;   ///< empty: the only one
  std::string text;  ///< a remark, or why
};
ExitCode pauseScript(const RequestOptions& options);
ExitCode resumeScript(const RequestOptions& options);
ExitCode markRun(const RequestOptions& options);
ExitCode endRun(const RequestOptions& options);

struct WebOptions {
  int port = 0;                         ///< the first one tried, 0: the usual one
  std::filesystem::path runs = "runs";  ///< folder of past runs
  std::filesystem::path programs;       ///< folder of the page's program
  bool open = false;                    ///< in the user's browser
};
ExitCode web(const WebOptions& options);

struct FlashOptions {
  std::string port;
  int baud = 57600;                ///< of the bootloader
  int robot_baud = 38400;          ///< of the program, as it was built
  std::string isp;                 ///< avrdude's name of a programmer, empty: by the bootloader
  std::string isp_port;            ///< of the programmer, empty: it needs none
  std::filesystem::path firmware;  ///< a .hex, empty: the one of this lab
  std::filesystem::path programs;  ///< folder of the programs and the firmware
};
ExitCode flash(const FlashOptions& options);

struct SpyOptions {
  std::string lab;
  std::string url;                ///< instead of a registered lab
  std::optional<double> seconds;  ///< then end; until Ctrl-C when not given
};
ExitCode spy(const SpyOptions& options);

}  // namespace lab::runner
