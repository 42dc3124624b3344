/// A ring of frames in shared memory, with one painter and a few readers, none of which waits.
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

/// The largest number of readers. Each may hold one slot while it reads, and the painter needs two
/// more: one to paint and one with the latest frame.
inline constexpr std::size_t kRingReaders = 6;
inline constexpr std::size_t kRingSlots = kRingReaders + 2;

/// The beginning of the shared memory. The pixels follow, slot by slot, on page boundaries.
///
/// A slot's `stamp` is odd while the slot is painted, and increases with every frame. A reader
/// first writes its `pin`, then compares the stamp with that of its notice. The painter first makes
/// the stamp odd, then checks the pins, and takes another slot if this one is pinned. All four
/// steps are sequentially consistent, so at least one side sees the other, and no frame is
/// overwritten while it is read.
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

/// Announces a frame to a reader, over its socket.
struct RingNotice {
  std::uint64_t slot = 0;
  std::uint64_t stamp = 0;
  std::int64_t number = 0;
  std::int64_t utime = 0;
};

/// Owns a memory mapping.
class Mapping {
 public:
  Mapping() = default;
  /// @throws CameraError if it cannot be mapped
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
  /// @throws CameraError if there is not enough memory
  explicit RingWriter(const CameraFormat& format);

  [[nodiscard]] int descriptor() const { return memory_.get(); }

  /// The pixels of the slot to paint: the oldest one without a reader. The same slot until
  /// publish().
  [[nodiscard]] std::span<std::uint8_t> canvas();

  /// Makes the painted slot a frame.
  [[nodiscard]] RingNotice publish(std::int64_t number, std::int64_t utime);

  /// Releases the slot of a reader that has disconnected.
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
  /// @throws CameraError if the memory is not a ring of this version
  RingReader(const FileDescriptor& memory, std::size_t reader);

  [[nodiscard]] const CameraFormat& format() const { return format_; }

  /// Pins the frame of this notice until release().
  /// @return its pixels; null if it has been overwritten
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
