#include "robot_bridge/lines/uid_writer.hpp"

#include <array>

namespace lab::bridge {
namespace {

constexpr std::int64_t kAnswer_us = 300'000;
constexpr std::int64_t kStoring_us = 1'000'000;  // EEPROM: 3.4 ms per byte

}  // namespace

UidWriter::UidWriter(Loop& loop, SerialPorts& ports, const std::string& path, int baud,
                     std::uint32_t uid)
    : loop_(loop),
      path_(path),
      baud_(baud),
      uid_(uid),
      port_(ports.open(path, baud)),
      session_(loop.now()) {
  port_->onReadable([this] { read(); });
}

void UidWriter::read() {
  std::array<std::uint8_t, 512> bytes;
  try {
    const std::size_t count = port_->read(bytes);
    session_.receive({bytes.data(), count}, loop_.now(),
                     [this](const wire::Frame& frame) { handle(frame); });
  } catch (const SerialError& error) {
    fail(error.what());
  }
}

void UidWriter::handle(const wire::Frame& frame) {
  wire::Hello hello;
  wire::Ack ack;
  if (wire::unpack(frame, hello)) {
    if (step_ == Step::kHello) start(Step::kSet);
    if (step_ == Step::kVerify) {
      if (hello.uid == uid_) {
        start(Step::kDone);
      } else {
        fail("the robot reports uid " + std::to_string(hello.uid) + " after storing another one");
      }
    }
  } else if (wire::unpack(frame, ack) && sender_.answer(ack.type, frame.seq)) {
    if (ack.status != wire::kOk) {
      fail("the robot refuses (message " + std::to_string(ack.type) + ", status " +
           std::to_string(ack.status) + ")");
    } else {
      start(step_ == Step::kSet ? Step::kStore : Step::kVerify);
    }
  }
}

void UidWriter::start(Step step) {
  step_ = step;
  switch (step) {
    case Step::kSet: {
      wire::SetParam message;
      message.id = wire::kUid;
      message.value = static_cast<std::int32_t>(uid_);
      command(message, kAnswer_us);
      break;
    }
    case Step::kStore:
      command(wire::Commit(), kStoring_us);
      break;
    case Step::kVerify:
      command(wire::GetInfo(), kAnswer_us);
      break;
    case Step::kHello:
    case Step::kDone:
      break;
  }
}

template <class Message>
void UidWriter::command(const Message& message, std::int64_t timeout_us) {
  wire::Frame frame;
  wire::pack(message, ++seq_, frame);
  sender_.begin(frame, loop_.now(), timeout_us);
  write(frame);
}

void UidWriter::write(const wire::Frame& frame) {
  std::array<std::uint8_t, wire::kMaxFrame> bytes;
  const std::size_t size = wire::encode(frame, bytes.data());
  try {
    static_cast<void>(port_->write({bytes.data(), size}));
  } catch (const SerialError& error) {
    fail(error.what());
  }
}

void UidWriter::fail(const std::string& why) {
  failure_ = why.starts_with(path_) ? why : path_ + ": " + why;
  step_ = Step::kDone;
}

bool UidWriter::tick() {
  if (step_ == Step::kDone) return true;
  if (step_ == Step::kHello) {
    session_.tick(loop_.now());
    if (!session_.outgoing().empty()) {
      static_cast<void>(port_->write(session_.outgoing()));
      session_.outgoing().clear();
    }
    if (!session_.reason(baud_).empty()) fail(session_.reason(baud_));
    return step_ == Step::kDone;
  }
  switch (sender_.check(loop_.now())) {
    case CommandSender::Due::kSendAgain:
      write(sender_.command());
      break;
    case CommandSender::Due::kGivenUp:
      fail("the robot no longer answers");
      break;
    case CommandSender::Due::kNothing:
      break;
  }
  return step_ == Step::kDone;
}

}  // namespace lab::bridge
