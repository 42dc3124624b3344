/// The commands of `lab`, one function each, as main() finds them on the command line. All throw
/// UserError for what the user can mend.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/exit_code.hpp"

namespace lab::runner {

struct RunOptions {
  std::filesystem::path file;
  std::filesystem::path out = "runs";  ///< where run folders are made
  std::filesystem::path programs;      ///< folder of the services' programs
  std::vector<std::string> set;        ///< key=value
  std::optional<std::uint64_t> seed;
  bool virtual_time = false;
  bool report = true;
};
ExitCode run(const RunOptions& options);

ExitCode check(const std::filesystem::path& file, const std::vector<std::string>& set);

ExitCode analyze(const std::filesystem::path& run_or_log,
                 const std::optional<std::filesystem::path>& out);

struct CalibrateOptions {
  std::filesystem::path file;
  std::filesystem::path out = "runs";  ///< where run folders are made
  std::filesystem::path programs;      ///< folder of the services' programs
  std::vector<std::string> set;        ///< key=value
  std::vector<std::int32_t> robots;    ///< empty: all
  bool virtual_time = false;
};
ExitCode calibrateMotors(const CalibrateOptions& options);

struct ReplayOptions {
  std::filesystem::path log;  ///< or the folder of a run
  double from = 0;            ///< [s] since the log's first event
  std::optional<double> to;   ///< [s]
  double speed = 1;           ///< log seconds a second
  bool loop = false;
  std::vector<std::string> channels;  ///< empty: all
  int port = 0;                       ///< 0: a free one
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

struct FlashOptions {
  std::string port;
  int baud = 57600;              ///< of the bootloader
  int robot_baud = 38400;        ///< of the program, as it was built
  std::string isp;               ///< avrdude's name of a programmer, empty: by the bootloader
  std::string isp_port;          ///< of the programmer, empty: it needs none
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
