/// Interface for cameras. A service gets it from outside, like its bus, its clock and its serial
/// lines: devices, movies and the simulated camera in real time, memory in virtual time. Frames are
/// never sent on the bus.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "light/optics/grey_image.hpp"

namespace lab {

/// A camera, movie or picture that cannot be used. what() names it, what was found, what was
/// expected and what to do.
class CameraError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a camera is requested to do, or what it does. 0 means not requested or not known.
struct CameraFormat {
  int width = 0;            ///< [px]
  int height = 0;           ///< [px]
  double fps = 0;           ///< [1/s]
  double exposure = 0;      ///< [s]
  double gain = 0;          ///< in the camera's own units
  std::string pixels;       ///< as the source names it: "GREY", "YUYV", "gray8 (png)"
  bool locked = false;      ///< exposure, gain and rate are fixed
  bool compressed = false;  ///< by a lossy codec: JPEG, H.264
  std::string name;         ///< of one of several simulated cameras, empty: the only one
};

/// One picture. The view is valid only during the handler's call.
struct CameraFrame {
  std::int64_t number = 0;  ///< counts the camera's frames from 0; a gap means dropped frames
  std::int64_t utime = 0;   ///< [us since 1970] middle of the exposure, in host time; of files:
                            ///< since their first frame, from 0
  optics::GreyView grey;
  bool search = false;  ///< the tracker searches the whole picture, as it did when it was filmed
};

/// The callbacks of a camera's reader. They are called on the loop's thread.
struct CameraHandlers {
  std::function<void(const CameraFrame&)> frame;
  /// The camera is lost (with the reason) or found again (empty text). A lost camera is searched
  /// for until it is found.
  std::function<void(const std::string& trouble)> trouble = [](const std::string&) {};
  /// A movie or sequence has ended; `problem` is empty if it ended as expected.
  std::function<void(const std::string& problem)> end = [](const std::string&) {};
};

/// An open camera. Destroying it closes it.
class FrameSource {
 public:
  FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;
  virtual ~FrameSource() = default;

  /// The camera's present format.
  [[nodiscard]] virtual CameraFormat format() const = 0;

  /// Frames since the source was opened that the camera took but no handler received.
  [[nodiscard]] virtual std::int64_t dropped() const = 0;

  /// The number of frames of a file, 0: not known.
  [[nodiscard]] virtual std::int64_t length() const { return 0; }
};

/// The painter's side of the simulated camera.
class FrameSink {
 public:
  FrameSink() = default;
  FrameSink(const FrameSink&) = delete;
  FrameSink& operator=(const FrameSink&) = delete;
  virtual ~FrameSink() = default;

  /// The memory of the next frame: width x height bytes, the top row first. Paint it, then call
  /// show().
  [[nodiscard]] virtual std::span<std::uint8_t> canvas() = 0;

  /// Passes the painted frame to the readers without waiting; slow readers lose frames.
  virtual void show(std::int64_t number, std::int64_t exposure_utime) = 0;

  /// Whether there is a reader. Without one, frames need not be painted.
  [[nodiscard]] virtual bool isWatched() const = 0;
};

/// The cameras that a process can use.
class Cameras {
 public:
  Cameras() = default;
  Cameras(const Cameras&) = delete;
  Cameras& operator=(const Cameras&) = delete;
  virtual ~Cameras() = default;

  /// Opens a camera (docs/cameras.md): "sim", "/dev/video0", a movie, a pattern of pictures, a
  /// network address, ... Files are read at `requested.fps`, or at their own rate.
  /// @throws CameraError if the camera does not exist or cannot do what is requested. An absent
  ///   simulated camera is no error: it is waited for, because its process may start later.
  [[nodiscard]] virtual std::unique_ptr<FrameSource> open(const std::string& source,
                                                          const CameraFormat& requested,
                                                          CameraHandlers handlers) = 0;

  /// Offers the simulated camera until the sink is destroyed.
  /// @throws CameraError if another process offers the simulated camera of this lab
  [[nodiscard]] virtual std::unique_ptr<FrameSink> offer(const CameraFormat& format) = 0;
};

/// Cameras for services that use none; open() and offer() throw.
[[nodiscard]] Cameras& noCameras();

}  // namespace lab
