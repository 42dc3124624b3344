/// The films of one start of the tracker, frame by frame through a tracker as it was in the run.
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
#include "common/service/service_main.hpp"
#include "tracker_svc/film_reader.hpp"

namespace lab::runner {

class FilmPass {
 public:
  /// @param films their folders: of one camera, or of several
  /// @param experiment must outlive the pass; it is not filmed again
  /// @param directory which the calibration's path is relative to
  /// @param log files of the run's log
  /// @throws CameraError, ExperimentError if film, table or calibration cannot be read, or the
  /// films
  ///   are not of the cameras of the experiment. Of several films one can be damaged: problem().
  FilmPass(const std::vector<std::filesystem::path>& films, const Experiment& experiment,
           const std::filesystem::path& directory, const std::vector<std::filesystem::path>& log);

  ~FilmPass();
  FilmPass(const FilmPass&) = delete;
  FilmPass& operator=(const FilmPass&) = delete;

  /// Shows the next frame to the tracker. @return false at the end of the films
  [[nodiscard]] bool next();

  /// Lets the tracker's time pass up to `utime`, but not beyond the next frame, or an hour after
  /// the last one.
  void passTime(std::int64_t utime);

  /// What the tracker published.
  struct Round {
    tracked_frame_t poses;
    tracked_details_t details;
  };
  /// By the last frame: one round if there is one camera; with several, 0 or more. Valid until
  /// next().
  [[nodiscard]] const std::vector<Round>& rounds() const { return rounds_; }
  /// The last frame. Valid until next().
  [[nodiscard]] const optics::GreyView& picture() const { return picture_.grey; }

  /// The tracker's last report, if it has reported.
  [[nodiscard]] const std::optional<tracker_status_t>& status() const { return status_; }

  [[nodiscard]] bool lossless() const;
  /// Of the first frame.
  [[nodiscard]] std::int64_t firstUtime() const;
  /// What the films of several cameras lack of what the tracker saw; empty: nothing.
  [[nodiscard]] std::string lacking() const;

  /// Why a film ended before its table; empty: none did.
  [[nodiscard]] std::string problem() const;

 private:
  class FilmCameras;

  /// A camera of the experiment, and its film.
  struct Film {
    std::string camera;     ///< empty: there is only one
    bool recorded = false;  ///< there is a film
    FilmFacts facts;
    std::vector<FilmFrame> table;
    std::unique_ptr<FilmReader> reader;
    std::size_t position = 0;  ///< of the next frame
    std::string problem;       ///< why it cannot be read
  };

  /// One ROBOT_STATUS of the log.
  struct Report {
    std::vector<std::uint8_t> data;
    std::int64_t received_utime = 0;
    std::int64_t instance = 0;
    std::int64_t seq = 0;
  };

  static std::vector<Film> openFilms(const std::vector<std::filesystem::path>& folders,
                                     const Experiment& experiment);
  static std::vector<std::size_t> orderOf(const std::vector<Film>& films);
  [[nodiscard]] std::int64_t startUtime() const;
  void feedReports(const FilmFrame& frame);
  [[nodiscard]] const std::optional<Report>& peekReport();

  std::vector<Film> films_;         ///< by camera of the experiment
  std::vector<std::size_t> order_;  ///< of the films
  std::size_t position_ = 0;        ///< in it
  std::int64_t shown_utime_;        ///< arrival of the last frame that was shown; before: the start
  LogReader log_;
  std::optional<Report> report_;  ///< the next in the log, if it was looked at
  std::int64_t fed_instance_ = 0;
  std::int64_t fed_seq_ = 0;
  VirtualLoop loop_;
  MemoryBus bus_;
  Node node_;
  std::unique_ptr<FilmCameras> cameras_;
  std::unique_ptr<Service> tracker_;
  CameraFrame picture_;
  std::vector<Round> rounds_;
  std::optional<tracker_status_t> status_;
};

}  // namespace lab::runner
