/// Films a running lab, for calibrations that need a film.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>

#include "runner/calibrate/calibrate_commands.hpp"
#include "runner/live/procedure.hpp"

namespace lab::runner {

/// Lets the robots run the programs of their light table and stores a camera picture every 0.5 s.
class LabFilm final : public Service {
 public:
  static constexpr std::int64_t kEvery_us = 500'000;

  /// @param folder for f0000.pgm etc. and frames.csv with their times
  /// @param pictures number of pictures
  /// @param done called after the last picture
  LabFilm(const ServiceContext& context, ExperimentController& controller,
          std::filesystem::path folder, std::int64_t pictures, std::function<void()> done);

 private:
  void take(const CameraFrame& frame);
  void startDriving();

  Loop& loop_;
  const Experiment& experiment_;
  ExperimentController& controller_;
  std::filesystem::path folder_;
  std::int64_t wanted_;
  std::function<void()> done_;
  std::int64_t kept_ = 0;
  std::int64_t first_utime_ = 0;
  std::int64_t next_utime_ = 0;
  std::ofstream times_;
  bool driving_ = false;
  std::unique_ptr<FrameSource> source_;
};

struct FilmedLab {
  std::string pictures;    ///< pattern of the file names
  std::string first;       ///< file name of the first picture
  std::string corners;     ///< as for --corners; empty if unknown
  std::string arena_cm;    ///< as for --arena-cm
  std::string origin_cm;   ///< as for --origin-cm
  std::int64_t count = 0;  ///< number of pictures
};

/// Runs the lab of an experiment file without its light script and films it.
/// @throws UserError
[[nodiscard]] FilmedLab filmLab(const CalibrateCameraOptions& options);

}  // namespace lab::runner
