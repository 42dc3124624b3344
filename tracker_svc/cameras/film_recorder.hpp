/// Writes the film of a run in a thread of its own.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/camera/run_film.hpp"
#include "common/experiment/experiment.hpp"
#include "tracker_svc/cameras/encoder_process.hpp"

namespace lab::cameras {

/// What the films of all cameras of a run have together.
struct SharedBounds {
  std::size_t films = 1;
  std::atomic<std::int64_t> bytes = 0;  ///< of the movies so far
};

struct FilmRecording {
  std::filesystem::path folder;  ///< for the movie, its table and its facts
  FilmSpec film;
  CameraFormat format;
  std::int64_t start_utime = 0;  ///< as FilmFacts
  bool may_wait =
      false;           ///< add() waits for the encoder, and no frame is lost; else it never waits
  std::string camera;  ///< as FilmFacts
  std::shared_ptr<SharedBounds> bounds = std::make_shared<SharedBounds>();
};

/// The arguments of ffmpeg, which reads an IVF stream of grey pictures on its input. IVF carries
/// the time of every frame.
[[nodiscard]] std::vector<std::string> encodeCommand(const FilmSpec& film, double fps,
                                                     const std::filesystem::path& movie);

/// Never throws after its construction: whatever goes wrong ends the film, and is said.
class FilmRecorder {
 public:
  /// Most bytes of pictures that wait for the encoders of a run; at least 4 pictures of a film may.
  /// With may_wait, 4 do.
  static constexpr std::size_t kQueueBytes = 128U << 20U;
  /// A film ends when less than this is free on its disk [bytes]: the log needs it.
  static constexpr std::uintmax_t kReserve = 500'000'000;

  /// @throws CameraError if ffmpeg is not installed, or the folder cannot be written
  explicit FilmRecorder(FilmRecording recording);
  /// Writes what waits, and completes the movie. Without may_wait, frames that are not encoded
  /// within a second are lost, and an encoder that hangs is killed after another one.
  ~FilmRecorder();
  FilmRecorder(const FilmRecorder&) = delete;
  FilmRecorder& operator=(const FilmRecorder&) = delete;

  /// Adds a frame. @param utime its time in the run. `frame.frame` and `frame.time` are filled in.
  void add(FilmFrame frame, std::int64_t utime, const optics::GreyView& picture);

  /// What has gone wrong since the last call, one line; empty: nothing new.
  [[nodiscard]] std::string news();

  /// The facts so far.
  [[nodiscard]] FilmFacts facts();

 private:
  struct Item {
    FilmFrame frame;
    std::int64_t utime = 0;
    optics::GreyImage picture;
  };

  void run();
  [[nodiscard]] std::string name() const;
  [[nodiscard]] FilmTable columns() const;
  [[nodiscard]] bool write(Item& item);
  [[nodiscard]] bool checkSize();
  void end(const std::string& problem);
  void complete();
  void saveFacts();

  FilmRecording recording_;
  std::filesystem::path movie_;
  std::size_t capacity_;  ///< [frames] of the queue
  std::optional<EncoderProcess> encoder_;
  std::ofstream table_;
  std::int64_t position_ = 0;      ///< of the next frame in the movie; the writer's
  std::int64_t first_camera_ = 0;  ///< camera_utime of the first frame; the writer's
  std::int64_t next_check_ = 0;    ///< position of the next look at the disk; the writer's
  std::int64_t shared_bytes_ = 0;  ///< of the movie, in SharedBounds; the writer's

  std::mutex mutex_;  ///< guards the members below
  std::condition_variable changed_;
  std::deque<Item> items_;
  std::vector<optics::GreyImage> spare_;
  FilmFacts facts_;
  std::string news_;
  bool loss_said_ = false;
  bool ended_ = false;    ///< no more frames are taken: the film has a problem
  bool closing_ = false;  ///< the destructor waits
  bool done_ = false;     ///< the thread has completed the film
  std::thread thread_;
};

}  // namespace lab::cameras
