/// Writers and readers of one topic each.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <functional>
#include <string>

#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/dds/waker.hpp"

namespace lab::dds {

/// What is asked of and offered to the other side. XCDR1 always: ROS 2 speaks nothing else.
struct Qos {
  bool reliable = true;
  bool latched = false;             ///< TRANSIENT_LOCAL: late joiners get the last ones
  int depth = 10;                   ///< KEEP_LAST, of each key
  int latched_depth = 0;            ///< what late joiners get, 0: as depth
  double max_blocking_time = 0.01;  ///< [s] a write may wait, reliable ones only
  std::string user_data;            ///< "typehash=RIHS01_...;"
};

/// How an endpoint fares; the counts since it was made.
struct Matching {
  int peers = 0;             ///< matched now
  std::int64_t joined = 0;   ///< ever matched
  std::int64_t refused = 0;  ///< of the same topic and type, whose QoS does not fit
  std::string why;           ///< the policy that did not fit last: "durability"
};

class Writer {
 public:
  /// @param topic DDS's name: "rt/lab/robot1/pose"
  /// @throws DdsError
  Writer(const Domain& domain, const dds_topic_descriptor_t& type, const std::string& topic,
         const Qos& qos);

  /// @param sample of the descriptor's C type; copied
  /// @return false when the time ran out: not sent, counted
  /// @throws DdsError for anything else
  bool write(const void* sample);

  /// Whether all readers that are there have all that was written; reliable ones only.
  [[nodiscard]] bool acknowledged() const;

  [[nodiscard]] std::int64_t written() const { return written_; }
  [[nodiscard]] std::int64_t timeouts() const { return timeouts_; }
  [[nodiscard]] Matching matching() const;

 private:
  std::string name_;
  Entity topic_;
  Entity writer_;
  std::int64_t written_ = 0;
  std::int64_t timeouts_ = 0;
};

/// Who sent a sample. Changes with each start of the sender.
using WriterId = std::uint64_t;

class Reader {
 public:
  /// @param waker rung on each arrival; outlives the reader
  /// @throws DdsError
  Reader(const Domain& domain, const dds_topic_descriptor_t& type, const std::string& topic,
         const Qos& qos, const Waker& waker);

  /// Calls `handler` with each sample that has arrived, at most `most` of them; the sample lives
  /// only during the call. Disposals and the like are skipped.
  /// @return how many there were; `most` when more may wait (ring the waker again)
  int take(int most, const std::function<void(const void* sample, WriterId writer)>& handler);

  [[nodiscard]] std::int64_t received() const { return received_; }
  /// Samples that were replaced before they were taken.
  [[nodiscard]] std::int64_t overrun() const;
  [[nodiscard]] Matching matching() const;

 private:
  std::string name_;
  Entity topic_;
  Entity reader_;
  std::int64_t received_ = 0;
};

}  // namespace lab::dds
