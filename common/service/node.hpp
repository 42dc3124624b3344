/// The service shell: what every process of the lab does the same way.
#pragma once

#include <functional>
#include <lab/service_status_t.hpp>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/stream_counter.hpp"
#include "common/loop/loop.hpp"

namespace lab {

/// Who a node says it is.
struct NodeIdentity {
  std::string name;           ///< the service, "sim_svc"
  std::int8_t origin = 0;     ///< robot_state_t's REAL, SIM, REPLAY or UNKNOWN
  std::int64_t instance = 1;  ///< new at each start, fixed in virtual time
};

/// Stamps what is published, counts what is sent, received, lost and not understood, and says so in
/// SERVICE_STATUS once a second. In virtual time nothing it says depends on host or process.
class Node {
 public:
  Node(Bus& bus, Loop& loop, NodeIdentity identity);
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// Starts the heartbeat. Subscribe before.
  void start();

  /// Stamps sender, instance and seq, and sends. A utime of 0 becomes now, and stays in `message`:
  /// who sends it again sets the next one.
  template <class Message>
  void publish(std::string_view channel, Message& message) {
    std::int64_t& sent = sentOn(channel);
    message.seq = sent + 1;
    send(channel, message, sent);
  }

  /// The same for a command, whose seq the caller sets: it stays while the command repeats.
  template <class Message>
  void publishCommand(std::string_view channel, Message& message) {
    send(channel, message, sentOn(channel));
  }

  /// Calls `handler` with every message of this channel that decodes; what does not is counted.
  template <class Message>
  void subscribe(std::string_view channel, std::function<void(const Message&)> handler) {
    bus_.subscribe(channel, [this, handler = std::move(handler)](const Packet& packet) {
      Message message{};
      if (!decode(packet.data, message)) {
        streams_.countDecodeError(packet.channel);
        return;
      }
      streams_.count(packet.channel, message.sender, message.instance, message.seq, message.utime);
      handler(message);
    });
  }

  /// Sends what another node stamped, unchanged: messages that come by another way than the bus.
  /// They are not counted as sent, being nobody's on this bus.
  void forward(std::string_view channel, Bytes data) { bus_.publish(channel, data); }

  /// Calls `handler` with every message of the lab on any channel, as it is: neither decoded nor
  /// counted.
  void subscribeAll(PacketHandler handler) { bus_.subscribeAll(std::move(handler)); }

  /// Says that the service does its job, at once.
  void ready();

  /// Says what is wrong, at once when that is a new state (a fault that repeats itself waits for
  /// the next heartbeat). The service goes on where it can.
  void fault(const std::string& what);

  /// Keeps an error for the heartbeat without changing the state.
  void noteError(const std::string& what) { last_error_ = what; }

  /// Adds rows to the heartbeat's counts of what was received: streams that do not come by the bus,
  /// as serial lines. They replace those given before.
  void reportStreams(std::vector<stream_count_t> rows) { other_streams_ = std::move(rows); }

  /// Says that the service ends, with the final counts, several times, as one may be lost.
  void close();

  [[nodiscard]] const NodeIdentity& identity() const { return identity_; }
  [[nodiscard]] const StreamCounter& streams() const { return streams_; }
  [[nodiscard]] Loop& loop() { return loop_; }

 private:
  void beat();
  std::int64_t& sentOn(std::string_view channel);

  template <class Message>
  void send(std::string_view channel, Message& message, std::int64_t& sent) {
    message.sender = identity_.name;
    message.instance = identity_.instance;
    if (message.utime == 0) message.utime = loop_.now();
    bus_.publish(channel, encode(message));
    ++sent;  // only what the transport took
  }

  Bus& bus_;
  Loop& loop_;
  NodeIdentity identity_;
  std::int64_t start_utime_;
  std::int8_t state_ = service_status_t::STARTING;
  std::string last_error_;
  std::map<std::string, std::int64_t, std::less<>> sent_;
  std::int64_t remaining_closing_reports_ = 0;  ///< messages of the closing salvo still to come
  StreamCounter streams_;
  std::vector<stream_count_t> other_streams_;
};

}  // namespace lab
