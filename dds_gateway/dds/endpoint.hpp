/// Writers and readers, each of one topic.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <functional>
#include <string>

#include "common/process/event_descriptor.hpp"
#include "dds_gateway/dds/domain.hpp"

namespace lab::dds {

/// Quality of service, requested or offered. The data representation is always XCDR1, as in ROS 2.
struct Qos {
  bool reliable = true;
  bool latched = false;             ///< TRANSIENT_LOCAL: late joiners get the last samples
  int depth = 10;                   ///< KEEP_LAST, for each key
  int latched_depth = 0;            ///< number of samples for late joiners, 0: depth
  double max_blocking_time = 0.01;  ///< [s] maximal duration of a write; reliable writers only
  std::string user_data;            ///< "typehash=RIHS01_...;"
};

/// Matches of an endpoint; counts since its creation.
struct Matching {
  int peers = 0;             ///< matched now
  std::int64_t joined = 0;   ///< matched since creation
  std::int64_t refused = 0;  ///< same topic and type, but incompatible QoS
  std::string why;           ///< the last incompatible policy: "durability"
};

class Writer {
 public:
  /// @param topic DDS's name: "rt/lab/robot1/pose"
  /// @throws DdsError
  Writer(const Domain& domain, const dds_topic_descriptor_t& type, const std::string& topic,
         const Qos& qos);

  /// @param sample an object of the descriptor's C type; is copied
  /// @return false after a timeout: the sample was not sent, and timeouts() counts it
  /// @throws DdsError for other errors
  bool write(const void* sample);

  /// Whether all matched reliable readers have received all samples.
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

/// Identifies the writer of a sample. Changes with each start of the writer.
using WriterId = std::uint64_t;

class Reader {
 public:
  /// @param waker is signalled on each arrival; must outlive the reader
  /// @throws DdsError
  Reader(const Domain& domain, const dds_topic_descriptor_t& type, const std::string& topic,
         const Qos& qos, const EventDescriptor& waker);

  /// Calls `handler` with each sample that has arrived, at most `most`; the sample is valid only
  /// during the call. Samples without data (disposals) are skipped.
  /// @return number of samples. If it is `most`, more may be waiting: signal the waker again.
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
