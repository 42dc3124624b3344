#include "common/camera/memory_cameras.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/camera/sim_camera.hpp"

namespace lab {

/// State shared by the camera and its readers.
struct MemoryCameras::Shared {
  struct Slot {
    std::int64_t shown = -1;  ///< number of frames shown before this one; -1: empty
    std::int64_t number = 0;
    std::int64_t utime = 0;
    std::vector<std::uint8_t> pixels;
  };
  /// One reader. Shared, because a handler may destroy its source while it runs.
  struct Reader {
    CameraFormat requested;
    std::shared_ptr<CameraHandlers> handlers;
    cameras::GapCounter gaps;
    bool open = true;
    bool mismatch = false;
  };

  explicit Shared(Loop& the_loop) : loop(the_loop) {}

  [[nodiscard]] Slot& slot(std::int64_t frame) {
    return slots[static_cast<std::size_t>(frame) % kSlots];
  }

  static void tell(const std::shared_ptr<Shared>& shared, const std::string& trouble) {
    for (const std::shared_ptr<Reader>& reader : shared->readers) {
      if (!trouble.empty()) reader->gaps.restart();
      shared->loop.soon([reader, trouble] {
        const std::shared_ptr<CameraHandlers> handlers = reader->handlers;
        if (reader->open) handlers->trouble(trouble);
      });
    }
  }

  /// Passes one frame to all readers, unless it has been overwritten.
  void deliver(std::int64_t frame) {
    const std::vector<std::shared_ptr<Reader>> now = readers;
    for (const std::shared_ptr<Reader>& reader : now) {
      Slot& place = slot(frame);
      if (place.shown != frame) return;
      if (reader->open && fits(*reader)) {
        reader->gaps.add(place.number);
        const std::shared_ptr<CameraHandlers> handlers = reader->handlers;
        handlers->frame({place.number,
                         place.utime,
                         {place.pixels.data(), format.width, format.height, format.width}});
      }
    }
  }

  [[nodiscard]] bool fits(Reader& reader) const {
    const std::string trouble = cameras::sizeTrouble(reader.requested, format);
    if (!trouble.empty() && !std::exchange(reader.mismatch, true))
      reader.handlers->trouble(trouble);
    return trouble.empty();
  }

  Loop& loop;
  bool offered = false;
  bool was_offered = false;
  CameraFormat format;
  std::array<Slot, kSlots> slots;
  std::int64_t shown = 0;
  std::vector<std::shared_ptr<Reader>> readers;
};

class MemoryCameras::Source final : public FrameSource {
 public:
  Source(std::shared_ptr<Shared> shared, const CameraFormat& requested, CameraHandlers handlers)
      : shared_(std::move(shared)), reader_(std::make_shared<Shared::Reader>()) {
    reader_->requested = requested;
    reader_->handlers = std::make_shared<CameraHandlers>(std::move(handlers));
    shared_->readers.push_back(reader_);
  }
  ~Source() override {
    reader_->open = false;
    std::erase(shared_->readers, reader_);
  }

  [[nodiscard]] CameraFormat format() const override {
    return shared_->offered ? cameras::paintedFormat(shared_->format) : CameraFormat{};
  }
  [[nodiscard]] std::int64_t dropped() const override { return reader_->gaps.missing(); }

 private:
  std::shared_ptr<Shared> shared_;
  std::shared_ptr<Shared::Reader> reader_;
};

class MemoryCameras::Sink final : public FrameSink {
 public:
  Sink(std::shared_ptr<Shared> shared, const CameraFormat& format) : shared_(std::move(shared)) {
    shared_->format = format;
    shared_->offered = true;
    for (const std::shared_ptr<Shared::Reader>& reader : shared_->readers) reader->mismatch = false;
    const std::size_t bytes =
        static_cast<std::size_t>(format.width) * static_cast<std::size_t>(format.height);
    for (Shared::Slot& slot : shared_->slots) slot = {-1, 0, 0, std::vector<std::uint8_t>(bytes)};
    if (std::exchange(shared_->was_offered, true)) Shared::tell(shared_, "");
  }
  ~Sink() override {
    shared_->offered = false;
    Shared::tell(shared_, cameras::kSimGone);
  }

  [[nodiscard]] std::span<std::uint8_t> canvas() override {
    Shared::Slot& slot = shared_->slot(shared_->shown);
    slot.shown = -1;  // readers that have not received it yet lose it
    return slot.pixels;
  }
  void show(std::int64_t number, std::int64_t exposure_utime) override {
    const std::int64_t frame = shared_->shown++;
    Shared::Slot& slot = shared_->slot(frame);
    slot.shown = frame;
    slot.number = number;
    slot.utime = exposure_utime;
    shared_->loop.soon([shared = shared_, frame] { shared->deliver(frame); });
  }
  [[nodiscard]] bool isWatched() const override { return !shared_->readers.empty(); }

 private:
  std::shared_ptr<Shared> shared_;
};

MemoryCameras::MemoryCameras(Loop& loop) : loop_(loop) {}

MemoryCameras::~MemoryCameras() = default;

const std::shared_ptr<MemoryCameras::Shared>& MemoryCameras::shared(const std::string& name) {
  std::shared_ptr<Shared>& place = shared_[name];
  if (!place) place = std::make_shared<Shared>(loop_);
  return place;
}

std::unique_ptr<FrameSource> MemoryCameras::open(const std::string& source,
                                                 const CameraFormat& requested,
                                                 CameraHandlers handlers) {
  if (source != "sim") {
    throw CameraError(source +
                      ": in virtual time there is only the simulated camera, \"sim\"; "
                      "run without --virtual-time, or read a recording with lab track");
  }
  return std::make_unique<Source>(shared(requested.name), requested, std::move(handlers));
}

std::unique_ptr<FrameSink> MemoryCameras::offer(const CameraFormat& format) {
  const std::shared_ptr<Shared>& camera = shared(format.name);
  if (camera->offered) throw CameraError(cameras::kSimTaken);
  cameras::checkPaintable(format);
  return std::make_unique<Sink>(camera, format);
}

}  // namespace lab
