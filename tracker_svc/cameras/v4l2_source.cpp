#include "tracker_svc/cameras/v4l2_source.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "common/camera/camera_source.hpp"
#include "common/camera/sim_camera.hpp"
#include "tracker_svc/cameras/v4l2_device.hpp"

namespace lab::cameras {
namespace {

// marks the state "gone", which is not reported again
constexpr const char* kNotThere = ": no camera there";
constexpr std::int64_t kDeviceLook_us = 1'000'000;
constexpr std::int64_t kSilence_us = 2'000'000;
constexpr int kMostEmptyCalls = 1000;  // readable but empty: the descriptor is broken

/// Frame numbers from the driver's 32-bit sequence, which restarts with each stream.
class Numbering {
 public:
  std::int64_t operator()(std::uint32_t sequence) {
    // Some drivers do not count, and some restart: then each frame is the next one.
    const std::uint32_t step = last_ ? sequence - *last_ : sequence + 1;
    const bool counts = step > 0 && step < (1U << 31U);
    number_ += last_ && counts ? step : 1;
    last_ = sequence;
    return number_;
  }
  void restart() { last_.reset(); }

 private:
  std::optional<std::uint32_t> last_;
  std::int64_t number_ = -1;
};

/// Shared with its timers and with a running handler, which may destroy the source.
class Capture : public std::enable_shared_from_this<Capture> {
 public:
  Capture(AsioLoop& loop, V4l2Calls& calls, const std::string& source, const CameraFormat& wanted,
          CameraHandlers handlers)
      : loop_(loop),
        calls_(calls),
        path_(videoDevicePath(source)),
        wanted_(wanted),
        handlers_(std::move(handlers)) {}

  /// @throws CameraError
  void open() {
    device_.emplace(calls_, path_, wanted_);
    numbering_.restart();
    empty_calls_ = 0;
    last_frame_ = loop_.now();
    watch_ = loop_.watch(device_->descriptor(), [this] {
      const std::shared_ptr<Capture> alive = shared_from_this();
      readAll();
    });
  }

  void close() {
    closed_ = true;
    watch_.reset();
    if (!in_handler_) device_.reset();
  }

  /// Once a second: reopens a lost camera, checks a running one.
  void lookLater() {
    loop_.at(loop_.now() + kDeviceLook_us, [capture = weak_from_this()] {
      const std::shared_ptr<Capture> here = capture.lock();
      if (!here || here->closed_) return;
      here->look();
      here->lookLater();
    });
  }

  [[nodiscard]] CameraFormat format() const { return device_ ? device_->format() : CameraFormat{}; }
  [[nodiscard]] std::int64_t dropped() const { return gaps_.missing(); }

 private:
  void look() {
    if (device_) {
      if (loop_.now() - last_frame_ > kSilence_us) {
        trouble(path_ + ": delivers no frames; are its light, lens cap and trigger right?");
      }
      return;
    }
    try {
      open();
    } catch (const CameraError& error) {
      const std::string reason = error.what();
      if (!reason.starts_with(path_ + kNotThere)) trouble(reason);
    }
  }

  void readAll() {
    for (int i = 0; i < 16 && device_ && !closed_; ++i) {
      V4l2Device::Raw raw;
      const V4l2Device::State state = device_->dequeue(raw);
      if (state == V4l2Device::State::kGone) return gone();
      if (state == V4l2Device::State::kNothing) {
        if (i == 0 && ++empty_calls_ > kMostEmptyCalls) gone();
        return;
      }
      empty_calls_ = 0;
      deliver(raw);
      if (closed_) {
        device_.reset();
      } else {
        device_->giveBack(raw);
      }
    }
  }

  void deliver(const V4l2Device::Raw& raw) {
    const std::int64_t number = numbering_(raw.sequence);
    const RawLayout& layout = device_->layout();
    CameraFrame frame{number, loop_.now() - raw.age, {}};
    if (raw.bytes.size() >= std::max<std::size_t>(rawBytes(layout), 1) && isGreyAlready(layout)) {
      frame.grey = {raw.bytes.data(), layout.width, layout.height, layout.stride};
    } else if (greyOfRaw(layout, raw.bytes, grey_)) {
      frame.grey = grey_.view();
    } else {
      return;  // damaged: counted as missing when the next one arrives
    }
    gaps_.add(number);
    last_frame_ = loop_.now();
    in_handler_ = true;
    if (std::exchange(trouble_, "") != "") handlers_.trouble("");
    if (!closed_) handlers_.frame(frame);
    in_handler_ = false;
  }

  void gone() {
    watch_.reset();
    device_.reset();
    trouble(path_ + ": the camera is gone (unplugged?); it is looked up every second");
  }

  void trouble(const std::string& reason) {
    if (std::exchange(trouble_, reason) != reason) handlers_.trouble(reason);
  }

  AsioLoop& loop_;
  V4l2Calls& calls_;
  std::string path_;
  CameraFormat wanted_;
  CameraHandlers handlers_;
  std::optional<V4l2Device> device_;
  std::unique_ptr<AsioLoop::Watch> watch_;  ///< destroyed before the device
  Numbering numbering_;
  GapCounter gaps_;
  optics::GreyImage grey_;
  std::string trouble_;
  std::int64_t last_frame_ = 0;
  int empty_calls_ = 0;
  bool in_handler_ = false;
  bool closed_ = false;
};

class V4l2Source final : public FrameSource {
 public:
  explicit V4l2Source(std::shared_ptr<Capture> capture) : capture_(std::move(capture)) {
    capture_->open();
    capture_->lookLater();
  }
  ~V4l2Source() override { capture_->close(); }

  [[nodiscard]] CameraFormat format() const override { return capture_->format(); }
  [[nodiscard]] std::int64_t dropped() const override { return capture_->dropped(); }

 private:
  std::shared_ptr<Capture> capture_;
};

}  // namespace

std::unique_ptr<FrameSource> openVideoDevice(AsioLoop& loop, V4l2Calls& calls,
                                             const std::string& source, const CameraFormat& wanted,
                                             CameraHandlers handlers) {
  return std::make_unique<V4l2Source>(
      std::make_shared<Capture>(loop, calls, source, wanted, std::move(handlers)));
}

}  // namespace lab::cameras
