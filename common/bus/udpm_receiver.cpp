#include "common/bus/udpm_receiver.hpp"

#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <new>
#include <system_error>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/loop/wall_clock.hpp"

namespace lab {
namespace {

constexpr int kBatch = 16;                     // datagrams per system call
constexpr std::size_t kLongest = 65'536;       // [byte] above the largest UDP datagram
constexpr std::size_t kControl = 128;          // [byte] for the three control messages below
constexpr std::size_t kMessageOverhead = 256;  // [byte] of a waiting message beside its data
constexpr int kLoopback = 1;                   // LOOPBACK_IFINDEX of the kernel (net/flow.h)

[[noreturn]] void failWith(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

FileDescriptor makeEvent() {
  FileDescriptor event(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (event.get() < 0) failWith("eventfd");
  return event;
}

template <class Value>
void set(const FileDescriptor& socket, int level, int option, const Value& value,
         const char* what) {
  if (setsockopt(socket.get(), level, option, &value, sizeof value) != 0) failWith(what);
}

FileDescriptor openSocket(const UdpmUrl& url) {
  FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (socket.get() < 0) failWith("socket");
  set(socket, SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR");
  if (url.receive_buffer > 0) {
    set(socket, SOL_SOCKET, SO_RCVBUF, url.receive_buffer, "SO_RCVBUF");
  }
  // Without these two the time is that of reading, and overflows are not counted.
  const int on = 1;
  static_cast<void>(setsockopt(socket.get(), SOL_SOCKET, SO_TIMESTAMP, &on, sizeof on));
  static_cast<void>(setsockopt(socket.get(), SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on));
  set(socket, IPPROTO_IP, IP_PKTINFO, 1, "IP_PKTINFO");
  // Without this option a socket also gets what comes in on interfaces where only other programs
  // have joined the group (man 7 ip).
  if (url.ttl > 0) set(socket, IPPROTO_IP, IP_MULTICAST_ALL, 0, "IP_MULTICAST_ALL");
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(url.port);
  address.sin_addr.s_addr = htonl(url.group);
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    failWith("bind");
  }
  // As liblcm: on the interface by which the group is routed.
  const ip_mreq membership{address.sin_addr, {htonl(INADDR_ANY)}};
  set(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, membership, "IP_ADD_MEMBERSHIP");
  return socket;
}

void signalEvent(const FileDescriptor& event) {
  const std::uint64_t one = 1;
  static_cast<void>(!write(event.get(), &one, sizeof one));
}

}  // namespace

/// Room for the datagrams of one system call.
class UdpmReceiver::Batch {
 public:
  struct Datagram {
    DatagramSource source;
    Bytes bytes;
    std::int64_t utime = 0;
    int interface_index = 0;
    std::optional<std::uint32_t> dropped;  ///< by the kernel, since the socket was opened
  };

  Batch() : bytes_(std::make_unique_for_overwrite<std::uint8_t[]>(kBatch * kLongest)) {}

  /// @return as recvmmsg()
  int receive(int socket) {
    for (std::size_t i = 0; i < kBatch; ++i) {
      vectors_[i] = {bytes_.get() + i * kLongest, kLongest};
      headers_[i].msg_hdr = {.msg_name = &sources_[i],
                             .msg_namelen = sizeof sources_[i],
                             .msg_iov = &vectors_[i],
                             .msg_iovlen = 1,
                             .msg_control = controls_[i].data,
                             .msg_controllen = kControl,
                             .msg_flags = 0};
    }
    return recvmmsg(socket, headers_.data(), kBatch, MSG_DONTWAIT, nullptr);
  }

  Datagram operator[](std::size_t i) {
    Datagram datagram{.source = {ntohl(sources_[i].sin_addr.s_addr), ntohs(sources_[i].sin_port)},
                      .bytes = {bytes_.get() + i * kLongest, headers_[i].msg_len},
                      .dropped = {}};
    msghdr& header = headers_[i].msg_hdr;
    for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
      if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_TIMESTAMP) {
        timeval time{};
        std::memcpy(&time, CMSG_DATA(c), sizeof time);
        datagram.utime = std::int64_t{time.tv_sec} * 1'000'000 + time.tv_usec;
      } else if (c->cmsg_level == IPPROTO_IP && c->cmsg_type == IP_PKTINFO) {
        in_pktinfo info{};
        std::memcpy(&info, CMSG_DATA(c), sizeof info);
        datagram.interface_index = info.ipi_ifindex;
      } else if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_RXQ_OVFL) {
        std::memcpy(&datagram.dropped.emplace(), CMSG_DATA(c), sizeof(std::uint32_t));
      }
    }
    if (datagram.utime == 0) datagram.utime = wallClock();
    return datagram;
  }

 private:
  struct Control {
    alignas(cmsghdr) std::uint8_t data[kControl];
  };
  std::unique_ptr<std::uint8_t[]> bytes_;
  std::array<sockaddr_in, kBatch> sources_{};
  std::array<iovec, kBatch> vectors_{};
  std::array<Control, kBatch> controls_{};
  std::array<mmsghdr, kBatch> headers_{};
};

UdpmReceiver::UdpmReceiver(const UdpmUrl& url)
    : is_open_(url.ttl > 0),
      socket_(openSocket(url)),
      waiting_event_(makeEvent()),
      stop_event_(makeEvent()),
      assembler_([this](std::string_view channel) {
        return wants_all_ || channel == channels::kLcmSelfTest || channels_.contains(channel);
      }) {
  // Signals are for the program's own threads.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    thread_ = std::thread([this] { read(); });
  } catch (...) {
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    throw;
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

UdpmReceiver::~UdpmReceiver() {
  signalEvent(stop_event_);
  thread_.join();
}

void UdpmReceiver::subscribe(std::string_view channel) {
  const std::lock_guard lock(mutex_);
  channels_.emplace(channel);
}

void UdpmReceiver::subscribeAll() {
  const std::lock_guard lock(mutex_);
  wants_all_ = true;
}

std::optional<UdpmMessage> UdpmReceiver::next() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return std::nullopt;
  UdpmMessage message = std::move(waiting_.front().message);
  waiting_.pop_front();
  waiting_bytes_ -= message.size + kMessageOverhead;
  if (waiting_.empty() && error_ == 0) {
    std::uint64_t count = 0;
    static_cast<void>(!::read(waiting_event_.get(), &count, sizeof count));
  }
  return message;
}

std::int64_t UdpmReceiver::backlog() const {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return 0;
  const auto waited = std::chrono::steady_clock::now() - waiting_.front().since;
  return std::chrono::duration_cast<std::chrono::microseconds>(waited).count();
}

int UdpmReceiver::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

bool UdpmReceiver::waitForProbe(int timeout_ms) {
  std::unique_lock lock(mutex_);
  return probed_.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                          [this] { return has_probe_; });
}

RefusedDatagrams UdpmReceiver::refused() const {
  const std::lock_guard lock(mutex_);
  return assembler_.refused();
}

/// The thread.
void UdpmReceiver::read() {
  Batch batch;
  std::array<pollfd, 2> waits{pollfd{socket_.get(), POLLIN, 0},
                              pollfd{stop_event_.get(), POLLIN, 0}};
  while (true) {
    if (poll(waits.data(), waits.size(), -1) < 0 && errno != EINTR) return fail(errno);
    if (waits[1].revents != 0) return;
    const int datagrams = batch.receive(socket_.get());
    if (datagrams >= 0) {
      takeBatch(batch, datagrams);
    } else if (errno != EAGAIN && errno != EINTR) {
      return fail(errno);
    }
  }
}

void UdpmReceiver::takeBatch(Batch& batch, int datagrams) {
  const std::lock_guard lock(mutex_);
  for (int i = 0; i < datagrams; ++i) {
    const Batch::Datagram datagram = batch[static_cast<std::size_t>(i)];
    if (datagram.dropped) countOverflow(*datagram.dropped, datagram.source);
    if (!accepts(datagram.source.address, datagram.interface_index)) {
      assembler_.refused().count(Refusal::kStranger, datagram.source);
      continue;
    }
    try {
      std::optional<UdpmMessage> message =
          assembler_.take(datagram.source, datagram.bytes, datagram.utime);
      if (message) keep(std::move(*message), datagram.source);
    } catch (const std::bad_alloc&) {
      assembler_.refused().count(Refusal::kQueueFull, datagram.source);
    }
  }
}

bool UdpmReceiver::accepts(std::uint32_t source, int interface_index) {
  return is_open_ || interface_index == kLoopback || own_addresses_.contains(source);
}

void UdpmReceiver::countOverflow(std::uint32_t dropped_since_start, const DatagramSource& source) {
  const std::uint32_t more = dropped_since_start - dropped_;  // the kernel counts modulo 2^32
  dropped_ = dropped_since_start;
  if (more > 0) assembler_.refused().count(Refusal::kReceiveBuffer, source, more);
}

void UdpmReceiver::keep(UdpmMessage message, const DatagramSource& source) {
  if (message.channel == channels::kLcmSelfTest) {
    has_probe_ = true;
    probed_.notify_all();
    return;
  }
  const std::size_t bytes = message.size + kMessageOverhead;
  if (waiting_bytes_ + bytes > kMostWaitingBytes) {
    assembler_.refused().count(Refusal::kQueueFull, source);
    return;
  }
  const bool is_first = waiting_.empty();
  waiting_.push_back({std::move(message), std::chrono::steady_clock::now()});
  waiting_bytes_ += bytes;
  if (is_first) signalEvent(waiting_event_);
}

void UdpmReceiver::fail(int error) {
  const std::lock_guard lock(mutex_);
  error_ = error;
  signalEvent(waiting_event_);
}

}  // namespace lab
