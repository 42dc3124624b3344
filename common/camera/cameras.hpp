/// Cameras, given to a service from outside like its bus, its clock and its serial lines: devices,
/// movies and the simulated camera in real time, memory in virtual time. Frames never travel on the
/// bus.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "light/optics/grey_image.hpp"

namespace lab {

/// A camera, movie or picture that cannot be used: which, what was found, what was expected, and
/// the way out.
class CameraError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What is asked of a camera, and what it turns out to do. 0: not asked, not known.
struct CameraFormat {
  int width = 0;            ///< [px]
  int height = 0;           ///< [px]
  double fps = 0;           ///< [1/s]
  double exposure = 0;      ///< [s]
  double gain = 0;          ///< in the camera's own units
  std::string pixels;       ///< as the source says it: "GREY", "YUYV", "gray8 (png)"
  bool locked = false;      ///< exposure, gain and rate are fixed: nothing adjusts itself
  bool compressed = false;  ///< by a codec that loses: JPEG, H.264
};

/// One picture. The view lives only during the handler's call.
struct CameraFrame {
  std::int64_t number =
      0;                   ///< counts the camera's frames from 0; a gap is a frame that was dropped
  std::int64_t utime = 0;  ///< [us since 1970] middle of the exposure, in host time; of files:
                           ///< since their first frame, from 0
  optics::GreyView grey;
};

/// Who reads a camera. All are called on the loop's thread.
struct CameraHandlers {
  std::function<void(const CameraFrame&)> frame;
  /// The camera is gone (a reason) or back (an empty text). It is looked for until it is back.
  std::function<void(const std::string& trouble)> trouble = [](const std::string&) {};
  /// A movie or sequence is over; `problem` says what was wrong with its end, empty: nothing.
  std::function<void(const std::string& problem)> end = [](const std::string&) {};
};

/// An open camera. Destroying it closes it.
class FrameSource {
 public:
  FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;
  virtual ~FrameSource() = default;

  /// What the camera does now.
  [[nodiscard]] virtual CameraFormat format() const = 0;

  /// Frames that the camera took and nobody got, since the source was opened.
  [[nodiscard]] virtual std::int64_t dropped() const = 0;

  /// How many frames a file has, 0: not known.
  [[nodiscard]] virtual std::int64_t length() const { return 0; }
};

/// The far side of the simulated camera.
class FrameSink {
 public:
  FrameSink() = default;
  FrameSink(const FrameSink&) = delete;
  FrameSink& operator=(const FrameSink&) = delete;
  virtual ~FrameSink() = default;

  /// Room for the next frame, width x height bytes, the top row first: paint into it, then show().
  [[nodiscard]] virtual std::span<std::uint8_t> canvas() = 0;

  /// Hands the painted frame over. Without waiting: who reads too slowly loses frames.
  virtual void show(std::int64_t number, std::int64_t exposure_utime) = 0;

  /// Whether anybody reads: else there is no need to paint.
  [[nodiscard]] virtual bool isWatched() const = 0;
};

/// All cameras there are.
class Cameras {
 public:
  Cameras() = default;
  Cameras(const Cameras&) = delete;
  Cameras& operator=(const Cameras&) = delete;
  virtual ~Cameras() = default;

  /// Opens a camera (docs/cameras.md): "sim", "/dev/video0", a movie, a pattern of pictures, a
  /// network address, ... Files are read at `wanted.fps`, or at their own rate.
  /// @throws CameraError when it is not there or cannot do what is wanted. The simulated camera is
  ///   waited for instead, as its process may start later.
  [[nodiscard]] virtual std::unique_ptr<FrameSource> open(const std::string& source,
                                                          const CameraFormat& wanted,
                                                          CameraHandlers handlers) = 0;

  /// The simulated camera, for as long as the sink lives.
  /// @throws CameraError when somebody else is the simulated camera of this lab.
  [[nodiscard]] virtual std::unique_ptr<FrameSink> offer(const CameraFormat& format) = 0;
};

/// No cameras at all: for what needs none.
[[nodiscard]] Cameras& noCameras();

}  // namespace lab
