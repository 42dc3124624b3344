#include "runner/user_program/lockstep.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "runner/command_line/print_line.hpp"

namespace lab::runner {
namespace {

constexpr int kPoll_ms = 50;
constexpr int kHandle = 3;                     // of the socket in the program
constexpr std::size_t kMostBytes = 1U << 24U;  // of a message; LCM takes less
constexpr std::size_t kLongestChannel = 63;
constexpr std::int64_t kFar_us = 1'000'000'000'000;  // longer waits need no timer
constexpr std::size_t kHead_bytes = 1 + 8 + 4 + 4;

template <class Integer>
void append(std::vector<std::uint8_t>& bytes, Integer value) {
  const auto at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

template <class Integer>
Integer numberAt(const std::uint8_t* at) {
  Integer value{};
  std::memcpy(&value, at, sizeof value);
  return value;
}

}  // namespace

Lockstep::Lockstep(Bus& bus, VirtualLoop& loop, std::function<bool()> interrupted,
                   std::function<void(const std::string&)> over)
    : bus_(bus), loop_(loop), interrupted_(std::move(interrupted)), over_(std::move(over)) {
  bus_.subscribeAll([this](const Packet& packet) { take(packet); });
}

void Lockstep::begin(const UserProgram& program, const std::filesystem::path& run) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::system_error(errno, std::generic_category(), "cannot make a socket");
  }
  socket_ = FileDescriptor(ends[0]);
  const FileDescriptor theirs(ends[1]);
  process_.emplace(program, run,
                   std::vector<std::string>{"ACTIVE_LAB_LOCKSTEP=" + std::to_string(kHandle)},
                   std::vector<std::pair<int, int>>{{ends[1], kHandle}});
  connected_ = true;
  serve();
}

void Lockstep::take(const Packet& packet) {
  if (!connected_ || concluding_ || !channels_.contains(packet.channel)) return;
  ++waits_;  // the timer of this wait is void
  send('m', packet.received_utime, packet.channel, packet.data);
  serve();
}

void Lockstep::wake(std::uint64_t wait) {
  if (!connected_ || concluding_ || wait != waits_) return;
  ++waits_;
  send('t', loop_.now());
  serve();
}

void Lockstep::serve() {
  while (connected_) {
    const std::optional<Frame> frame = read();
    if (!frame) {
      connected_ = false;
      programEnded();
      return;
    }
    if (frame->what == 'h') {
      send('t', loop_.now());
    } else if (frame->what == 'c') {
      channels_.clear();
    } else if (frame->what == 's') {
      channels_.insert(frame->channel);
    } else if (frame->what == 'p') {
      bus_.publish(frame->channel, frame->message);
    } else if (frame->what == 'w') {
      if (frame->utime < loop_.now() + kFar_us) {
        loop_.at(frame->utime, [this, wait = waits_] { wake(wait); });
      }
      return;
    }
  }
}

void Lockstep::programEnded() {
  if (concluding_) return;
  // The socket closes a little before the process ends.
  process_->waitForEnd(interrupted_);
  reported_ = true;
  over_(interrupted_() ? std::string() : process_->problem());
}

void Lockstep::conclude() {
  if (!connected_) return;
  concluding_ = true;
  send('e', loop_.now());
  while (connected_) {
    const std::optional<Frame> frame = read();
    if (!frame) {
      connected_ = false;
    } else if (frame->what == 'c') {
      return;
    } else if (frame->what == 'p') {
      bus_.publish(frame->channel, frame->message);
    } else if (frame->what == 'w' || frame->what == 'h') {
      send('e', loop_.now());
    }
  }
}

std::string Lockstep::end() {
  socket_ = FileDescriptor();
  if (!process_ || reported_) return {};
  process_->waitForEnd(interrupted_);
  return process_->problem();
}

void Lockstep::send(char what, std::int64_t utime, std::string_view channel, Bytes message) {
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(what)};
  bytes.reserve(kHead_bytes + channel.size() + message.size());
  append(bytes, utime);
  append(bytes, static_cast<std::uint32_t>(channel.size()));
  append(bytes, static_cast<std::uint32_t>(message.size()));
  bytes.insert(bytes.end(), channel.begin(), channel.end());
  bytes.insert(bytes.end(), message.begin(), message.end());
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count =
        ::send(socket_.get(), bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return;  // the program has gone; read() notices it
    sent += static_cast<std::size_t>(count);
  }
}

std::optional<Lockstep::Frame> Lockstep::read() {
  waits_since_ = std::chrono::steady_clock::now();
  std::array<std::uint8_t, kHead_bytes> head{};
  if (!readExactly(head.data(), head.size())) return std::nullopt;
  if (!heard_) {
    heard_ = true;
    said_wait_ = false;
  }
  Frame frame;
  frame.what = static_cast<char>(head[0]);
  frame.utime = numberAt<std::int64_t>(&head[1]);
  const auto channel = numberAt<std::uint32_t>(&head[9]);
  const auto message = numberAt<std::uint32_t>(&head[13]);
  if (channel > kLongestChannel || message > kMostBytes) return std::nullopt;
  frame.channel.resize(channel);
  frame.message.resize(message);
  if (!readExactly(reinterpret_cast<std::uint8_t*>(frame.channel.data()), channel) ||
      !readExactly(frame.message.data(), message)) {
    return std::nullopt;
  }
  return frame;
}

bool Lockstep::readExactly(std::uint8_t* to, std::size_t size) {
  while (size > 0) {
    pollfd ready{socket_.get(), POLLIN, 0};
    const int found = ::poll(&ready, 1, kPoll_ms);
    // A program that computes without end must not keep the user from ending the run.
    if (found == 0 && interrupted_()) return false;
    if (found == 0 && !process_->running()) return false;
    if (found == 0) sayLongWait();
    if (found <= 0) continue;
    const ssize_t count = ::recv(socket_.get(), to, size, 0);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    to += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

void Lockstep::sayLongWait() {
  if (said_wait_ || std::chrono::steady_clock::now() - waits_since_ < kSilentWait) return;
  said_wait_ = true;
  printLine(heard_ ? fmt::format("waiting while {} computes: virtual time stands still until it "
                                 "waits for the lab; Ctrl-C ends both",
                                 process_->name())
                   : fmt::format("waiting for {}: the run begins when it calls active_lab.Lab(), "
                                 "or when it ends; Ctrl-C ends both",
                                 process_->name()));
}

}  // namespace lab::runner
