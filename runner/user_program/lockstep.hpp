/// A user program in virtual time: time stands still while it computes.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/process/file_descriptor.hpp"
#include "runner/user_program/user_program.hpp"

namespace lab::runner {

/// Passes messages between the bus and a program on a socket (python/active_lab/lockstep.py).
///
/// Both sides write frames: a letter, a time (int64), the lengths of a channel's name and of a
/// message (uint32 each; all little-endian, without padding), the name, the message.
///
///   to the program:   t  the time is ...; answers h, and ends a wait
///                     m  a message on a channel that it has subscribed
///                     e  the run is over
///   from the program: h  begins to take part
///                     s  subscribes a channel
///                     p  publishes a message
///                     w  has nothing to do until a message comes, at the latest until ...
///                     c  takes part no longer; it may begin again
///
/// The program computes between a frame to it and its next `w`. The loop waits for that, so the
/// program's time is exactly the loop's, and a deterministic program gives the same run every time.
/// The first wait that takes longer than kSilentWait is said on the terminal, once before the
/// program's first frame and once after it.
class Lockstep {
 public:
  /// Subscribes to the bus: before messages are delivered.
  /// @param interrupted asked while the program computes; true: the user wants the run to end
  /// @param over called once when the program has ended during the run, with its problem, or with
  ///   an empty text
  Lockstep(Bus& bus, VirtualLoop& loop, std::function<bool()> interrupted,
           std::function<void(const std::string&)> over);

  /// Starts the program and lets it come to its first wait.
  void begin(const UserProgram& program, const std::filesystem::path& run);

  /// The run is over: the program sends its last messages.
  void conclude();

  /// Waits for the end of the process.
  /// @return its problem, if over() was not called with it; empty: none
  [[nodiscard]] std::string end();

 private:
  struct Frame {
    char what = 0;
    std::int64_t utime = 0;
    std::string channel;
    std::vector<std::uint8_t> message;
  };

  void take(const Packet& packet);
  void send(char what, std::int64_t utime, std::string_view channel = {}, Bytes message = {});
  void serve();
  void wake(std::uint64_t wait);
  void programEnded();
  [[nodiscard]] std::optional<Frame> read();
  [[nodiscard]] bool readExactly(std::uint8_t* to, std::size_t size);
  void sayLongWait();

  Bus& bus_;
  VirtualLoop& loop_;
  std::function<bool()> interrupted_;
  std::function<void(const std::string&)> over_;
  FileDescriptor socket_;
  std::optional<UserProcess> process_;
  std::set<std::string, std::less<>> channels_;
  std::uint64_t waits_ = 0;
  std::chrono::steady_clock::time_point waits_since_;
  bool heard_ = false;      // at least one frame came from the program
  bool said_wait_ = false;  // since heard_ changed
  bool connected_ = false;
  bool reported_ = false;
  bool concluding_ = false;
};

}  // namespace lab::runner
