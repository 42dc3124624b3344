/// Pictures of a lab that is running, for what is calibrated from films.
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

/// Lets the robots run their light table, and keeps a picture of the camera now and then.
class LabFilm final : public Service {
 public:
  static constexpr std::int64_t kEvery_us = 500'000;

  /// @param folder gets f0000.pgm and so on, and frames.csv with their times
  /// @param pictures how many
  /// @param done called when all are there
  LabFilm(const ServiceContext& context, ExperimentController& controller,
          std::filesystem::path folder, std::int64_t pictures, std::function<void()> done);

 private:
  void take(const CameraFrame& frame);
  void watch();

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
  std::string pictures;    ///< pattern
  std::string first;       ///< of them
  std::string corners;     ///< as --corners has them, empty: not known
  std::string arena_cm;    ///< as --arena-cm has it
  std::int64_t count = 0;  ///< of pictures
};

/// Runs the lab of an experiment file without its script, and films it.
/// @throws UserError for what the user can mend
[[nodiscard]] FilmedLab filmLab(const CalibrateCameraOptions& options);

}  // namespace lab::runner
