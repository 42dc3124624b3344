/// The messaging part that all services share: headers, counts, heartbeat.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <lab/service_status_t.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/bus/arrival_clock.hpp"
#include "common/bus/bus.hpp"
#include "common/bus/message_header.hpp"
#include "common/bus/message_values.hpp"
#include "common/bus/received_message.hpp"
#include "common/bus/stream_counter.hpp"
#include "common/loop/loop.hpp"

namespace lab {

/// The identity of a node in its messages.
struct NodeIdentity {
  std::string name;           ///< the service, "sim_svc"
  std::int8_t origin = 0;     ///< robot_state_t's REAL, SIM, REPLAY or UNKNOWN
  std::int64_t instance = 1;  ///< new at each start, fixed in virtual time
};

/// Fills in the header of published messages, counts sent, received, lost and undecodable messages,
/// and reports the counts in SERVICE_STATUS once a second. In virtual time its messages depend on
/// neither host nor process.
class Node {
 public:
  Node(Bus& bus, Loop& loop, NodeIdentity identity);
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// Starts the heartbeat. Subscribe before calling it.
  void start();

  /// Sets sender, instance and seq, and sends the message. A utime of 0 is set to now, and remains
  /// in `message`: set it again before sending the same object again.
  template <class Message>
  void publish(std::string_view channel, Message& message) {
    std::int64_t& sent = sentOn(channel);
    message.seq = sent + 1;
    send(channel, message, sent);
  }

  /// As publish() for a command, whose seq the caller sets: a repeated command keeps its seq.
  template <class Message>
  void publishCommand(std::string_view channel, Message& message) {
    send(channel, message, sentOn(channel));
  }

  /// Calls `handler` with every message of this channel whose numbers are possible
  /// (message_values.hpp) and whose time continues that of its stream (arrival_clock.hpp). The
  /// others, undecodable ones, those that are too large (message_sizes.hpp), and robots that were
  /// removed from a message are counted as decode errors; the reason is in the heartbeat. So are
  /// those without a possible header: heartbeats repeat the name of each sender. A stop is handled
  /// and counted whatever its header holds.
  template <class Message>
  void subscribe(std::string_view channel, std::function<void(const Message&)> handler) {
    std::optional<ArrivalClock> clock;
    if (timesFollowClock(channel)) clock.emplace();
    bus_.subscribe(channel, [this, handler = std::move(handler),
                             clock = std::move(clock)](const Packet& packet) mutable {
      const std::optional<MessageHeader> header = peekHeader(packet.data);
      if (!header && !std::is_same_v<Message, robot_stop_t>) {
        refuseWithoutHeader(packet);
        return;
      }
      const auto received = receive<Message>(packet);
      const Message& message = received->message;
      const std::string_view sender = header ? header->sender : countedName(message.sender);
      if (const auto& found = received->removed) {
        refuse(packet.channel, sender, found->first, found->count);
        if (!found->usable) return;
      } else if (!received->decoded) {
        streams_.countDecodeError(packet.channel);
        return;
      }
      const std::int64_t now = loop_.now();
      if (clock && !clock->accepts(sender, message.instance, message.utime, now)) {
        refuse(packet.channel, sender, lateOrEarly(message.utime, now), 1);
        return;
      }
      streams_.count(packet.channel, sender, message.instance, message.seq, message.utime);
      if (streams_.uncounted() > 0) noteStreamLimit();
      handler(message);
    });
  }

  /// Sends a message of another node unchanged, such as one from another host's bus. It is not
  /// counted as sent by this node.
  void forward(std::string_view channel, Bytes data) { bus_.publish(channel, data); }

  /// Calls `handler` with every message on any channel, neither decoded nor counted.
  void subscribeAll(PacketHandler handler) { bus_.subscribeAll(std::move(handler)); }

  /// Reports at once that the service is ready.
  void ready();

  /// Reports a fault: at once if the service had none, else with the next heartbeat, which has the
  /// latest fault. The service continues as far as it can.
  void fault(const std::string& what);

  /// Reports an error with the next heartbeat without changing the state. A heartbeat has all
  /// errors since the one before it, joined by "; ", up to a thousand bytes; the others follow with
  /// later heartbeats, and a longer one is cut. Without new errors a heartbeat repeats the text of
  /// the one before it.
  /// @param subject of an error whose text changes, such as a growing count: a text that no
  /// heartbeat has reported yet is replaced by the next one of the same subject
  void noteError(const std::string& what, std::string_view subject = {});

  /// Adds rows to the heartbeat's counts of received messages, for streams that do not use the bus,
  /// such as serial lines. They replace the rows of an earlier call.
  void reportStreams(std::vector<stream_count_t> rows) { other_streams_ = std::move(rows); }

  /// As reportStreams(), for rows that are read at each heartbeat: the bus's own losses.
  void reportBus(std::function<std::vector<stream_count_t>()> rows) { bus_rows_ = std::move(rows); }

  /// Reports the end of the service with its final counts, several times because a message may be
  /// lost.
  void close();

  /// As Bus::backlog().
  [[nodiscard]] std::int64_t backlog() const { return bus_.backlog(); }

  [[nodiscard]] const NodeIdentity& identity() const { return identity_; }
  [[nodiscard]] const StreamCounter& streams() const { return streams_; }
  [[nodiscard]] Loop& loop() { return loop_; }

 private:
  struct WaitingError {
    std::string text;
    std::string subject;  ///< empty: none
  };

  void beat();
  [[nodiscard]] std::string nextErrors();
  void refuse(std::string_view channel, std::string_view sender, const std::string& problem,
              std::int64_t count);
  void refuseWithoutHeader(const Packet& packet);
  /// The beginning of a name that may be too long for a header.
  static std::string_view countedName(std::string_view sender);
  void noteStreamLimit();
  static std::string lateOrEarly(std::int64_t utime, std::int64_t now);
  std::int64_t& sentOn(std::string_view channel);

  template <class Message>
  void send(std::string_view channel, Message& message, std::int64_t& sent) {
    message.sender = identity_.name;
    message.instance = identity_.instance;
    if (message.utime == 0) message.utime = loop_.now();
    bus_.publish(channel, encode(message));
    ++sent;  // not if the bus threw
  }

  Bus& bus_;
  Loop& loop_;
  NodeIdentity identity_;
  std::int64_t start_utime_;
  std::int8_t state_ = service_status_t::STARTING;
  std::string fault_;                ///< not yet in a heartbeat
  std::deque<WaitingError> errors_;  ///< not yet in a heartbeat
  std::string last_error_;
  std::map<std::string, std::int64_t, std::less<>> sent_;
  std::int64_t remaining_closing_reports_ = 0;  ///< closing messages still to be sent
  StreamCounter streams_;
  std::set<std::string, std::less<>> refused_on_;  ///< channels whose refusals have been named
  bool stream_limit_noted_ = false;
  std::vector<stream_count_t> other_streams_;
  std::function<std::vector<stream_count_t>()> bus_rows_;
};

}  // namespace lab
