#include "common/camera/shared_camera.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/camera/frame_ring.hpp"
#include "common/camera/sim_camera.hpp"
#include "light/field/image.hpp"

namespace lab::cameras {
namespace {

constexpr std::int64_t kRetry_us = 100'000;            // between attempts to connect
constexpr std::int64_t kAbsentTimeout_us = 2'000'000;  // until its absence is reported
constexpr std::size_t kMostWaiting = kRingSlots / 2;   // older frames are skipped

struct Address {
  sockaddr_un name{};
  socklen_t length = 0;
};

/// An abstract socket address, which has no file.
Address addressOf(const std::filesystem::path& folder) {
  const std::string path = std::filesystem::weakly_canonical(folder).string();
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(path.data());
  const std::string name = "active-lab-camera-" + std::to_string(getuid()) + "-" +
                           light::sha256({bytes, path.size()}).substr(0, 32);
  Address address;
  address.name.sun_family = AF_UNIX;
  std::copy(name.begin(), name.end(), address.name.sun_path + 1);
  address.length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return address;
}

sockaddr* generic(Address& address) { return reinterpret_cast<sockaddr*>(&address.name); }

FileDescriptor newSocket() {
  FileDescriptor line(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (line.get() < 0) throw CameraError(std::string("sim: no socket: ") + std::strerror(errno));
  return line;
}

bool isOwnUser(int line) {
  ucred peer{};
  socklen_t length = sizeof peer;
  return getsockopt(line, SOL_SOCKET, SO_PEERCRED, &peer, &length) == 0 && peer.uid == getuid();
}

/// Sends one message: the reader's number, with the memory's descriptor.
/// @return whether it was sent
bool sendMemory(int line, std::uint64_t reader, int memory) {
  iovec content{&reader, sizeof reader};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> space{};
  msghdr message{};
  message.msg_iov = &content;
  message.msg_iovlen = 1;
  message.msg_control = space.data();
  message.msg_controllen = space.size();
  cmsghdr* rights = CMSG_FIRSTHDR(&message);
  rights->cmsg_level = SOL_SOCKET;
  rights->cmsg_type = SCM_RIGHTS;
  rights->cmsg_len = CMSG_LEN(sizeof(int));
  std::memcpy(CMSG_DATA(rights), &memory, sizeof memory);
  return sendmsg(line, &message, MSG_DONTWAIT | MSG_NOSIGNAL) == sizeof reader;
}

/// Receives a message of sendMemory().
/// @param reader out: the reader's number
/// @return the memory; no descriptor if there is no message, or one without memory
FileDescriptor receiveMemory(int line, std::uint64_t& reader) {
  iovec content{&reader, sizeof reader};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> space{};
  msghdr message{};
  message.msg_iov = &content;
  message.msg_iovlen = 1;
  message.msg_control = space.data();
  message.msg_controllen = space.size();
  if (recvmsg(line, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC) != sizeof reader) {
    return FileDescriptor();
  }
  const cmsghdr* rights = CMSG_FIRSTHDR(&message);
  if (rights == nullptr || rights->cmsg_type != SCM_RIGHTS) return FileDescriptor();
  int memory = -1;
  std::memcpy(&memory, CMSG_DATA(rights), sizeof memory);
  return FileDescriptor(memory);
}

class SharedSink final : public FrameSink {
 public:
  SharedSink(AsioLoop& loop, const std::filesystem::path& folder, const CameraFormat& format)
      : loop_(loop), ring_(format), listener_(newSocket()) {
    Address address = addressOf(folder);
    if (bind(listener_.get(), generic(address), address.length) != 0) {
      throw CameraError(errno == EADDRINUSE
                            ? std::string(kSimTaken)
                            : std::string("sim: cannot be offered: ") + std::strerror(errno));
    }
    if (listen(listener_.get(), 16) != 0) {
      throw CameraError(std::string("sim: cannot be offered: ") + std::strerror(errno));
    }
    watch_ = loop_.watch(listener_.get(), [this] { accept(); });
  }

  [[nodiscard]] std::span<std::uint8_t> canvas() override { return ring_.canvas(); }

  void show(std::int64_t number, std::int64_t exposure_utime) override {
    const RingNotice notice = ring_.publish(number, exposure_utime);
    for (const std::unique_ptr<Reader>& reader : readers_) {
      // The socket is full if the reader is far behind. The reader then loses this frame.
      static_cast<void>(
          !send(reader->line.get(), &notice, sizeof notice, MSG_DONTWAIT | MSG_NOSIGNAL));
    }
  }

  [[nodiscard]] bool isWatched() const override { return !readers_.empty(); }

 private:
  struct Reader {
    FileDescriptor line;
    std::size_t number = 0;
    std::unique_ptr<AsioLoop::Watch> watch;  ///< must end before the socket is closed
  };

  void accept() {
    FileDescriptor line(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (line.get() < 0 || !isOwnUser(line.get())) return;
    std::size_t number = 0;
    while (number < kRingReaders && taken_[number]) ++number;
    const bool has_room = number < kRingReaders;
    // A surplus reader gets a number without memory, which tells it the reason.
    if (!has_room) {
      const std::uint64_t none = number;
      static_cast<void>(!send(line.get(), &none, sizeof none, MSG_DONTWAIT | MSG_NOSIGNAL));
      return;
    }
    if (!sendMemory(line.get(), number, ring_.descriptor())) return;
    taken_[number] = true;
    auto reader = std::make_unique<Reader>();
    Reader* const here = reader.get();
    reader->line = std::move(line);
    reader->number = number;
    // Readers never send anything: a readable socket means that the reader has closed it.
    reader->watch = loop_.watch(reader->line.get(), [this, here] { drop(here); });
    readers_.push_back(std::move(reader));
  }

  void drop(const Reader* reader) {
    taken_[reader->number] = false;
    ring_.unpin(reader->number);
    std::erase_if(readers_, [reader](const auto& one) { return one.get() == reader; });
  }

  AsioLoop& loop_;
  RingWriter ring_;
  FileDescriptor listener_;
  std::unique_ptr<AsioLoop::Watch> watch_;
  std::bitset<kRingReaders> taken_;
  std::vector<std::unique_ptr<Reader>> readers_;
};

/// The reader's connection. Shared with its timers and with running handlers, because a handler may
/// destroy the source.
class Link : public std::enable_shared_from_this<Link> {
 public:
  Link(AsioLoop& loop, const std::filesystem::path& folder, const CameraFormat& requested,
       CameraHandlers handlers)
      : loop_(loop),
        address_(addressOf(folder)),
        requested_(requested),
        handlers_(std::move(handlers)),
        report_absence_at_(loop.now() + kAbsentTimeout_us) {}

  /// Tries to connect, and again until it succeeds.
  void tryConnect() {
    if (closed_) return;
    if (!connect()) {
      if (loop_.now() >= report_absence_at_ && !troubled_) trouble(kSimAbsent);
      retryLater();
    }
  }

  void close() {
    closed_ = true;
    watch_.reset();
    line_ = FileDescriptor();
  }

  [[nodiscard]] CameraFormat format() const { return ring_ ? ring_->format() : CameraFormat{}; }
  [[nodiscard]] std::int64_t dropped() const { return gaps_.missing(); }

 private:
  void retryLater() {
    loop_.at(loop_.now() + kRetry_us, [link = weak_from_this()] {
      if (const std::shared_ptr<Link> here = link.lock()) here->tryConnect();
    });
  }

  bool connect() {
    FileDescriptor line = newSocket();
    if (::connect(line.get(), generic(address_), address_.length) != 0) return false;
    if (!isOwnUser(line.get())) return false;
    line_ = std::move(line);
    watch_ = loop_.watch(line_.get(), [this] {
      const std::shared_ptr<Link> alive = shared_from_this();
      ring_ ? readNotices() : readWelcome();
    });
    return true;
  }

  void readWelcome() {
    std::uint64_t reader = 0;
    const FileDescriptor memory = receiveMemory(line_.get(), reader);
    if (memory.get() < 0) {
      lost(reader == kRingReaders
               ? "sim: " + std::to_string(kRingReaders) + " programs read it already; end one"
               : std::string(kSimGone));
      return;
    }
    try {
      ring_.emplace(memory, reader);
    } catch (const CameraError& error) {
      lost(error.what());
      return;
    }
    gaps_.restart();
    const std::string mismatch = sizeTrouble(requested_, ring_->format());
    fits_ = mismatch.empty();
    if (!fits_) {
      trouble(mismatch);
    } else if (troubled_) {
      troubled_ = false;
      handlers_.trouble("");
    }
  }

  void readNotices() {
    std::vector<RingNotice> notices;
    RingNotice notice;
    ssize_t count = 0;
    while ((count = recv(line_.get(), &notice, sizeof notice, MSG_DONTWAIT)) == sizeof notice) {
      notices.push_back(notice);
    }
    const bool gone = count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR);
    const std::size_t first = notices.size() - std::min(notices.size(), kMostWaiting);
    for (std::size_t i = first; i < notices.size() && !closed_; ++i) deliver(notices[i]);
    if (gone && !closed_) lost(kSimGone);
  }

  void deliver(const RingNotice& notice) {
    if (!fits_) return;
    const std::uint8_t* pixels = ring_->hold(notice);
    if (pixels == nullptr) return;  // painted over; counted by the gap in the numbers
    gaps_.add(notice.number);
    const CameraFormat& format = ring_->format();
    handlers_.frame(
        {notice.number, notice.utime, {pixels, format.width, format.height, format.width}});
    if (!closed_)
      ring_->release();  // else the painter has unpinned, and another reader may use the pin
  }

  void lost(const std::string& reason) {
    watch_.reset();
    line_ = FileDescriptor();
    ring_.reset();
    retryLater();
    trouble(reason);
  }

  void trouble(const std::string& reason) {
    if (std::exchange(trouble_, reason) == reason && troubled_) return;
    troubled_ = true;
    handlers_.trouble(reason);
  }

  AsioLoop& loop_;
  Address address_;
  CameraFormat requested_;
  CameraHandlers handlers_;
  std::int64_t report_absence_at_;
  bool closed_ = false;
  bool troubled_ = false;
  bool fits_ = true;
  std::string trouble_;
  FileDescriptor line_;
  std::unique_ptr<AsioLoop::Watch> watch_;
  std::optional<RingReader> ring_;
  GapCounter gaps_;
};

class SharedSource final : public FrameSource {
 public:
  explicit SharedSource(std::shared_ptr<Link> link) : link_(std::move(link)) {
    link_->tryConnect();
  }
  ~SharedSource() override { link_->close(); }

  [[nodiscard]] CameraFormat format() const override { return link_->format(); }
  [[nodiscard]] std::int64_t dropped() const override { return link_->dropped(); }

 private:
  std::shared_ptr<Link> link_;
};

/// Each of several cameras has an address of its own.
std::filesystem::path folderOf(const std::filesystem::path& folder, const CameraFormat& format) {
  return format.name.empty() ? folder : folder / format.name;
}

}  // namespace

std::unique_ptr<FrameSink> offerSharedCamera(AsioLoop& loop, const std::filesystem::path& folder,
                                             const CameraFormat& format) {
  checkPaintable(format);
  return std::make_unique<SharedSink>(loop, folderOf(folder, format), format);
}

std::unique_ptr<FrameSource> openSharedCamera(AsioLoop& loop, const std::filesystem::path& folder,
                                              const CameraFormat& requested,
                                              CameraHandlers handlers) {
  return std::make_unique<SharedSource>(
      std::make_shared<Link>(loop, folderOf(folder, requested), requested, std::move(handlers)));
}

}  // namespace lab::cameras
