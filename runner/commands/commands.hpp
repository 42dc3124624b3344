/// The small commands of `lab`, one function each. All throw UserError for what the user can
/// correct.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/command_line/command_main.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {

ExitCode check(const std::filesystem::path& file, const std::vector<std::string>& set);

struct ReplayOptions {
  std::filesystem::path log;  ///< or the folder of a run
  double from = 0;            ///< [s] since the log's first event
  std::optional<double> to;   ///< [s]
  double speed = 1;           ///< seconds of the log per second
  double max_gap = 10;        ///< [s] longer gaps are shortened to this
  bool loop = false;
  std::vector<std::string> channels;  ///< empty: all
  int port = 0;                       ///< 0: a free one
  bool web = false;                   ///< with the dashboard
  std::filesystem::path programs;     ///< folder of the lab's programs
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
  bool clear = false;  ///< release the stop instead
};
ExitCode stop(const StopOptions& options);

/// A request to a running experiment or to a log that is played.
struct RequestOptions {
  std::string lab;   ///< empty: the only one
  std::string text;  ///< a remark, or a reason
};
ExitCode pauseScript(const RequestOptions& options);
ExitCode resumeScript(const RequestOptions& options);
ExitCode markRun(const RequestOptions& options);
ExitCode endRun(const RequestOptions& options);

struct WebOptions {
  int port = 0;                         ///< first port tried, 0: the default
  std::filesystem::path runs = "runs";  ///< folder of past runs
  std::filesystem::path programs;       ///< folder of the lab's programs
  bool open = false;                    ///< open it in the user's browser
};
ExitCode web(const WebOptions& options);

struct FlashOptions {
  std::string port;
  int baud = 57600;                ///< of the bootloader
  int robot_baud = 38400;          ///< of the robot's program
  std::string isp;                 ///< avrdude's name of a programmer, empty: use the bootloader
  std::string isp_port;            ///< port of the programmer, empty: it needs none
  std::filesystem::path firmware;  ///< a .hex, empty: the one that this lab has built
  std::filesystem::path programs;  ///< folder of the programs and the firmware
};
ExitCode flash(const FlashOptions& options);

struct PythonOptions {
  std::vector<std::string> arguments;  ///< of Python
  bool where = false;                  ///< print the folder of the package instead
};
/// Becomes Python, with the package active_lab.
ExitCode python(const PythonOptions& options);

struct SpyOptions {
  std::string lab;
  std::string url;                ///< of a bus, instead of a registered lab
  std::optional<double> seconds;  ///< then ends; not given: runs until Ctrl-C
};
ExitCode spy(const SpyOptions& options);

}  // namespace lab::runner
