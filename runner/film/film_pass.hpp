/// One film of a run, frame by frame through a tracker as it was in the run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <lab/tracker_status_t.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/camera/run_film.hpp"
#include "common/experiment/experiment.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/service/node.hpp"
#include "tracker_svc/film_reader.hpp"
#include "tracker_svc/tracker_service.hpp"

namespace lab::runner {

class FilmPass {
 public:
  /// @param film its folder
  /// @param experiment must outlive the pass; its film is not recorded again
  /// @param directory which the calibration's path is relative to
  /// @param log files of the run's log
  /// @throws CameraError, ExperimentError if film, table or calibration cannot be read
  FilmPass(const std::filesystem::path& film, const Experiment& experiment,
           const std::filesystem::path& directory, const std::vector<std::filesystem::path>& log);

  /// Tracks the next frame. @return false at the end of the film
  [[nodiscard]] bool next();

  /// Lets the tracker's time pass up to `utime`, but not beyond the next frame.
  void passTime(std::int64_t utime);

  /// Of the last frame. Valid until next().
  [[nodiscard]] const tracked_frame_t& poses() const { return poses_; }
  [[nodiscard]] const tracked_details_t& details() const { return details_; }
  [[nodiscard]] const optics::GreyView& picture() const { return picture_.grey; }

  /// The tracker's last report, if it has reported.
  [[nodiscard]] const std::optional<tracker_status_t>& status() const { return status_; }

  [[nodiscard]] const FilmFacts& facts() const { return facts_; }

  /// Why the film ended before its table; empty: it did not.
  [[nodiscard]] std::string problem() const;

 private:
  class FilmCameras;

  /// One ROBOT_STATUS of the log.
  struct Report {
    std::vector<std::uint8_t> data;
    std::int64_t received_utime = 0;
    std::int64_t instance = 0;
    std::int64_t seq = 0;
  };

  void feedReports(const FilmFrame& frame);
  [[nodiscard]] const std::optional<Report>& peekReport();

  FilmFacts facts_;
  std::vector<FilmFrame> table_;
  std::unique_ptr<FilmReader> reader_;
  LogReader log_;
  std::optional<Report> report_;  ///< the next in the log, if it was looked at
  std::int64_t fed_instance_ = 0;
  std::int64_t fed_seq_ = 0;
  VirtualLoop loop_;
  MemoryBus bus_;
  Node node_;
  std::unique_ptr<FilmCameras> cameras_;
  std::unique_ptr<tracker::TrackerService> tracker_;
  std::size_t position_ = 0;
  CameraFrame picture_;
  tracked_frame_t poses_{};
  tracked_details_t details_{};
  std::optional<tracker_status_t> status_;
};

}  // namespace lab::runner
