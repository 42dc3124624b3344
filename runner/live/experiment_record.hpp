/// What the runner writes into the record of a run: EXPERIMENT_EVENT.
#pragma once

#include <cstddef>
#include <functional>
#include <lab/experiment_event_t.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/loop/loop.hpp"
#include "common/service/node.hpp"

namespace lab::runner {

/// Sends START, faults, remarks and END. Its memory and what it sends stay bounded, whatever others
/// publish on the bus: of faults, remarks and END it takes the first 3000 bytes.
class ExperimentRecord {
 public:
  /// Each event is sent so often, because LCM may drop messages.
  static constexpr int kCopies = 3;

  /// @param effective the experiment file with every default filled in
  ExperimentRecord(Node& node, Loop& loop, std::string effective)
      : node_(node), loop_(loop), effective_(std::move(effective)) {}

  /// @param text of the calibration file of light that the run uses
  void setLightCalibration(std::string text) { light_calibration_ = std::move(text); }

  /// Gets what is written into the record as a mark: "request" or "warning", and what happened.
  using Announce = std::function<void(const std::string& label, const std::string& what)>;

  /// Sets what is called, for the terminal, with the marks of requests and warnings.
  void announceMarks(Announce announce) { announce_ = std::move(announce); }

  /// Sends the experiment file, the versions and the calibration of light.
  void start();

  /// Sends an event. Its utime is filled in.
  void write(experiment_event_t event);

  /// Writes a fault, and keeps it for faults().
  void fault(const std::string& text);

  void mark(const std::string& what);

  /// Writes a remark about a request of somebody else, and announces it with what undoes it.
  void markRequest(const std::string& what, const std::string& way_out = {});

  /// Writes a fault that a bound was reached, once. @param what one of a few texts
  void limitReached(const std::string& what);

  /// Writes an error that a service reports, once.
  /// @param costs_data whether it is a fault; otherwise it is a warning, which is announced
  void serviceError(const std::string& text, bool costs_data);

  void end(const std::string& why);

  [[nodiscard]] const std::vector<std::string>& faults() const { return faults_; }

 private:
  void markAndAnnounce(const std::string& label, const std::string& text,
                       const std::string& way_out);

  Node& node_;
  Loop& loop_;
  std::string effective_;
  std::string light_calibration_;  ///< empty: none
  Announce announce_;
  std::vector<std::string> faults_;
  std::set<std::string> service_errors_;  ///< those written
  std::set<std::string> limits_reached_;  ///< those written
};

}  // namespace lab::runner
