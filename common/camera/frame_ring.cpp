#include "common/camera/frame_ring.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <string>
#include <utility>

namespace lab::cameras {
namespace {

constexpr std::size_t kPage = 4096;
constexpr std::size_t kPixelsAt = kPage;
static_assert(sizeof(RingHeader) <= kPage);

[[noreturn]] void fail(const std::string& what) {
  throw CameraError("sim: shared memory: " + what + ": " + std::strerror(errno));
}

std::size_t frameBytes(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

/// The distance between slots [bytes]: whole pages.
std::size_t slotBytes(std::size_t frame) { return (frame + kPage - 1) / kPage * kPage; }

std::size_t ringBytes(std::size_t frame) { return kPixelsAt + kRingSlots * slotBytes(frame); }

/// Memory whose size is sealed, so that no process can shrink it below what others have mapped.
FileDescriptor newMemory(std::size_t bytes) {
  FileDescriptor memory(memfd_create("active-lab-camera", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (memory.get() < 0) fail("none to be had");
  if (ftruncate(memory.get(), static_cast<off_t>(bytes)) != 0) {
    fail(std::to_string(bytes) + " bytes are not to be had");
  }
  if (fcntl(memory.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) {
    fail("cannot be sealed");
  }
  return memory;
}

}  // namespace

Mapping::Mapping(int descriptor, std::size_t bytes, std::size_t offset, bool writable)
    : bytes_(bytes) {
  void* memory = mmap(nullptr, bytes, writable ? PROT_READ | PROT_WRITE : PROT_READ, MAP_SHARED,
                      descriptor, static_cast<off_t>(offset));
  if (memory == MAP_FAILED) fail("cannot be mapped");
  data_ = static_cast<std::uint8_t*>(memory);
}

Mapping::Mapping(Mapping&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), bytes_(other.bytes_) {}

Mapping& Mapping::operator=(Mapping&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

Mapping::~Mapping() {
  if (data_ != nullptr) munmap(data_, bytes_);
}

RingWriter::RingWriter(const CameraFormat& format)
    : bytes_(frameBytes(format.width, format.height)),
      memory_(newMemory(ringBytes(bytes_))),
      mapping_(memory_.get(), ringBytes(bytes_), 0, true),
      header_(new (mapping_.data()) RingHeader) {
  header_->width = format.width;
  header_->height = format.height;
  header_->fps = format.fps;
  header_->exposure = format.exposure;
  header_->gain = format.gain;
}

bool RingWriter::isPinned(std::size_t slot) const {
  for (const std::atomic<std::uint64_t>& pin : header_->pins) {
    if (pin.load() == slot + 1) return true;
  }
  return false;
}

std::span<std::uint8_t> RingWriter::canvas() {
  // Every reader pins at most one slot, so one round over the slots finds a free one. If a faulty
  // reader has pinned more, the last slot of the round is used, so that the painter never waits.
  for (std::size_t tried = 1; !painting_; ++tried) {
    const std::size_t slot = next_;
    next_ = (next_ + 1) % kRingSlots;
    std::atomic<std::uint64_t>& stamp = header_->stamps[slot];
    stamp.store(stamp.load() + 1);
    if (tried < kRingSlots && isPinned(slot)) {
      stamp.store(stamp.load() - 1);
    } else {
      painting_ = slot;
    }
  }
  return {mapping_.data() + kPixelsAt + *painting_ * slotBytes(bytes_), bytes_};
}

RingNotice RingWriter::publish(std::int64_t number, std::int64_t utime) {
  static_cast<void>(canvas());
  const std::size_t slot = *std::exchange(painting_, std::nullopt);
  const std::uint64_t stamp = header_->stamps[slot].load() + 1;
  header_->stamps[slot].store(stamp);
  return {slot, stamp, number, utime};
}

void RingWriter::unpin(std::size_t reader) { header_->pins[reader].store(0); }

RingReader::RingReader(const FileDescriptor& memory, std::size_t reader) : reader_(reader) {
  struct stat state {};
  const int seals = fcntl(memory.get(), F_GET_SEALS);
  const bool fixed = seals >= 0 && (seals & F_SEAL_SHRINK) != 0;
  if (!fixed || fstat(memory.get(), &state) != 0 || state.st_size < static_cast<off_t>(kPage)) {
    throw CameraError("sim: found other memory than a camera's; are all programs of one version?");
  }
  control_ = Mapping(memory.get(), kPage, 0, true);
  header_ = std::launder(reinterpret_cast<RingHeader*>(control_.data()));
  const std::size_t frame = frameBytes(header_->width, header_->height);
  if (header_->magic != RingHeader::kMagic || reader >= kRingReaders || frame == 0 ||
      static_cast<std::size_t>(state.st_size) != ringBytes(frame)) {
    throw CameraError("sim: found a camera of another version; build all programs anew");
  }
  format_ = {header_->width,
             header_->height,
             header_->fps,
             header_->exposure,
             header_->gain,
             "GREY (painted)",
             true,
             false,
             ""};
  pixels_ = Mapping(memory.get(), ringBytes(frame) - kPixelsAt, kPixelsAt, false);
}

const std::uint8_t* RingReader::hold(const RingNotice& notice) {
  if (notice.slot >= kRingSlots) return nullptr;
  header_->pins[reader_].store(notice.slot + 1);
  if (header_->stamps[notice.slot].load() != notice.stamp) {
    release();
    return nullptr;
  }
  return pixels_.data() + notice.slot * slotBytes(frameBytes(format_.width, format_.height));
}

void RingReader::release() { header_->pins[reader_].store(0); }

}  // namespace lab::cameras
