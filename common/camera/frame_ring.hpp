/// Frames in memory that several processes share: one paints, a few read, nobody waits.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/camera/cameras.hpp"
#include "common/process/file_descriptor.hpp"

namespace lab::cameras {

/// So many readers at once: each may hold one slot while it reads, and the painter needs one that
/// is free and one that is fresh.
inline constexpr std::size_t kRingReaders = 6;
inline constexpr std::size_t kRingSlots = kRingReaders + 2;

/// What lies at the beginning of the memory. The pixels follow from kPixelsAt on, slot by slot.
///
/// A slot's `stamp` is odd while it is painted and grows with every frame. A reader first writes
/// its `pin`, then compares the stamp with that of its notice; the painter first makes the stamp
/// odd, then looks for pins, and takes another slot where there is one. In the one order of these
/// four steps (all sequentially consistent) at least one of the two sees the other, so that no
/// frame is painted over while it is read.
struct RingHeader {
  static constexpr std::uint64_t kMagic = 0x316d61636c6263ULL;  // "cblcam1"

  std::uint64_t magic = kMagic;
  std::int32_t width = 0;
  std::int32_t height = 0;
  double fps = 0;
  double exposure = 0;
  double gain = 0;
  std::array<std::atomic<std::uint64_t>, kRingSlots> stamps{};
  std::array<std::atomic<std::uint64_t>, kRingReaders> pins{};  ///< slot + 1, 0: none
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

/// Tells a reader of a frame, over its socket.
struct RingNotice {
  std::uint64_t slot = 0;
  std::uint64_t stamp = 0;
  std::int64_t number = 0;
  std::int64_t utime = 0;
};

/// Memory that is mapped as long as this lives.
class Mapping {
 public:
  Mapping() = default;
  /// @throws CameraError when it cannot be mapped.
  Mapping(int descriptor, std::size_t bytes, std::size_t offset, bool writable);
  Mapping(Mapping&& other) noexcept;
  Mapping& operator=(Mapping&& other) noexcept;
  ~Mapping();

  [[nodiscard]] std::uint8_t* data() const { return data_; }

 private:
  std::uint8_t* data_ = nullptr;
  std::size_t bytes_ = 0;
};

/// The painter's side. The memory has no name and ends with the last process that maps it.
class RingWriter {
 public:
  /// @throws CameraError when there is no memory for it.
  explicit RingWriter(const CameraFormat& format);

  [[nodiscard]] int descriptor() const { return memory_.get(); }

  /// A slot that nobody reads, the one whose frame is oldest; the same until publish().
  [[nodiscard]] std::span<std::uint8_t> canvas();

  /// The painted slot becomes a frame.
  [[nodiscard]] RingNotice publish(std::int64_t number, std::int64_t utime);

  /// Forgets what a reader that is gone held.
  void unpin(std::size_t reader);

 private:
  [[nodiscard]] bool isPinned(std::size_t slot) const;

  std::size_t bytes_;  ///< of a frame
  FileDescriptor memory_;
  Mapping mapping_;
  RingHeader* header_;
  std::optional<std::size_t> painting_;
  std::size_t next_ = 0;
};

/// A reader's side.
class RingReader {
 public:
  /// @param memory as received from the painter
  /// @param reader its number among the readers
  /// @throws CameraError when the memory is not what it should be.
  RingReader(const FileDescriptor& memory, std::size_t reader);

  [[nodiscard]] const CameraFormat& format() const { return format_; }

  /// Keeps the frame of this notice for release(). @return its pixels, null: it is painted over.
  [[nodiscard]] const std::uint8_t* hold(const RingNotice& notice);
  void release();

 private:
  Mapping control_;  ///< the header, writable for the pin
  Mapping pixels_;   ///< the frames, read only
  RingHeader* header_ = nullptr;
  std::size_t reader_;
  CameraFormat format_;
};

}  // namespace lab::cameras
