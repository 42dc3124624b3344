#include "runner/commands/robot_adoption.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <utility>

#include "common/experiment/experiment.hpp"
#include "robot/wire/fields.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kBootloader_us = 2'500'000;  // the stock one takes 1.3 s
constexpr std::int64_t kRetry_us = 300'000;
constexpr std::int64_t kAdoptionTimeout_us = 10'000'000;

/// "it is busy (status 5)"
std::string statusText(std::uint8_t status) {
  const char* meaning = "another error";
  switch (status) {
    case wire::kUnknownType:
      meaning = "it does not know this command";
      break;
    case wire::kBadLength:
      meaning = "the command has a wrong length";
      break;
    case wire::kBadValue:
      meaning = "the value is not allowed";
      break;
    case wire::kWrongConfig:
      meaning = "it has other settings";
      break;
    case wire::kBusy:
      meaning = "it is busy";
      break;
    case wire::kStoreFailed:
      meaning = "writing its EEPROM failed";
      break;
    default:
      break;
  }
  return fmt::format("{} (status {})", meaning, status);
}

}  // namespace

struct RobotAdoption::Talk : std::enable_shared_from_this<Talk> {
  enum class Phase { kGreet, kSetUid, kCommit, kAskAgain, kDone };

  Talk(Loop& its_loop, std::unique_ptr<SerialPort> its_line, std::uint32_t uid,
       std::function<void(const Result&)> callback)
      : loop(its_loop), line(std::move(its_line)), fresh_uid(uid), done(std::move(callback)) {}

  void begin() {
    line->onReadable([talk = weak_from_this()] {
      if (const auto here = talk.lock()) here->read();
    });
    later(kBootloader_us, [](Talk& talk) { talk.askAgainAndAgain(); });
    later(kAdoptionTimeout_us, [](Talk& talk) { talk.giveUp(); });
  }

  void later(std::int64_t delay_us, void (*what)(Talk&)) {
    loop.at(loop.now() + delay_us, [talk = weak_from_this(), what] {
      if (const auto here = talk.lock()) what(*here);
    });
  }

  void askAgainAndAgain() {
    if (phase == Phase::kDone) return;
    ask();
    later(kRetry_us, [](Talk& talk) { talk.askAgainAndAgain(); });
  }

  // Commands are repeated with the same number until they are answered.
  void ask() {
    switch (phase) {
      case Phase::kGreet:
      case Phase::kAskAgain:
        say(wire::GetInfo{});
        break;
      case Phase::kSetUid: {
        wire::SetParam param;
        param.id = wire::kUid;
        param.value = static_cast<std::int32_t>(fresh_uid);
        say(param);
        break;
      }
      case Phase::kCommit:
        say(wire::Commit{});
        break;
      case Phase::kDone:
        break;
    }
  }

  template <class Message>
  void say(const Message& message) {
    wire::Frame frame;
    wire::pack(message, seq, frame);
    std::array<std::uint8_t, wire::kMaxFrame> bytes{};
    const std::uint8_t size = wire::encode(frame, bytes.data());
    try {
      // If the line accepts only a part, this frame is lost and will be repeated.
      (void)line->write(std::span(bytes).first(size));
    } catch (const SerialError& error) {
      end(error.what());
    }
  }

  void read() {
    const auto stay = shared_from_this();  // done() may destroy the owner
    std::array<std::uint8_t, 256> bytes{};
    try {
      for (std::size_t n = line->read(bytes); n > 0 && phase != Phase::kDone;
           n = line->read(bytes)) {
        for (std::size_t i = 0; i < n && phase != Phase::kDone; ++i) {
          if (decoder.push(bytes[i])) hear(decoder.frame());
        }
      }
    } catch (const SerialError& error) {
      end(error.what());
    }
  }

  void hear(const wire::Frame& frame) {
    wire::Hello hello;
    wire::Ack ack;
    if (wire::unpack(frame, hello)) {
      hearHello(hello);
    } else if (wire::unpack(frame, ack) && frame.seq == seq) {
      hearAck(ack);
    }
  }

  void hearHello(const wire::Hello& hello) {
    result.hello = hello;
    if (hello.schema != wire::kSchema) {
      end(fmt::format(
          "the robot uses protocol schema 0x{:04X}, this lab 0x{:04X}; flash it with this lab's "
          "firmware",
          hello.schema, wire::kSchema));
    } else if (phase == Phase::kGreet) {
      if (hello.uid != 0) {
        end({});
      } else {
        go(Phase::kSetUid);
      }
    } else if (phase == Phase::kAskAgain) {
      result.uid_is_new = hello.uid == fresh_uid;
      end(result.uid_is_new ? std::string() : "the robot has not kept its uid; flash it again");
    }
  }

  void hearAck(const wire::Ack& ack) {
    if (phase == Phase::kSetUid && ack.type == wire::SetParam::kType) {
      ack.status == wire::kOk ? go(Phase::kCommit) : refuse("the new uid", ack);
    } else if (phase == Phase::kCommit && ack.type == wire::Commit::kType) {
      ack.status == wire::kOk ? go(Phase::kAskAgain) : refuse("to store the new uid", ack);
    }
  }

  void go(Phase next) {
    phase = next;
    ++seq;
    ask();
  }

  void refuse(const char* what, const wire::Ack& ack) {
    end(fmt::format("the robot refuses {}: {}", what, statusText(ack.status)));
  }

  void giveUp() {
    if (phase == Phase::kDone) return;
    std::string found = "no answer from a robot";
    if (decoder.foreignVersion() != 0) {
      found = fmt::format("frames of protocol version {}", decoder.foreignVersion());
    } else if (phase != Phase::kGreet) {
      found = "a robot that said HELLO but does not answer";
    } else if (decoder.counts().crc + decoder.counts().malformed > 0) {
      found = "bytes that are no frames of a robot";
    }
    end(fmt::format(
        "found {} within {} s; check its power and the speed of the line (--robot-baud)", found,
        kAdoptionTimeout_us / 1'000'000));
  }

  void end(const std::string& problem) {
    if (phase == Phase::kDone) return;
    phase = Phase::kDone;
    result.ok = problem.empty();
    result.problem = problem;
    done(result);
  }

  Loop& loop;
  std::unique_ptr<SerialPort> line;
  std::uint32_t fresh_uid;
  std::function<void(const Result&)> done;
  Phase phase = Phase::kGreet;
  std::uint8_t seq = 1;
  wire::Decoder decoder;
  Result result;
};

RobotAdoption::RobotAdoption(Loop& loop, std::unique_ptr<SerialPort> line, std::uint32_t fresh_uid,
                             std::function<void(const Result&)> done)
    : talk_(std::make_shared<Talk>(loop, std::move(line), fresh_uid, std::move(done))) {
  talk_->begin();
}

RobotAdoption::~RobotAdoption() = default;

std::uint32_t randomUid() {
  std::random_device device;
  for (;;) {
    const std::uint32_t uid = device();
    if (uid >> 24 != simulatedUid(0) >> 24 && uid != 0) return uid;
  }
}

}  // namespace lab::runner
