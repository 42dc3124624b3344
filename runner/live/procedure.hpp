/// A procedure (a calibration) that drives the robots of a run instead of their light table.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "runner/live/experiment_controller.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {

/// Makes a procedure beside the controller, before the run begins. The robots stand still until the
/// procedure commands them.
/// @param context with a node of the procedure's own
/// @param done ends the run
using ProcedureFactory = std::function<std::unique_ptr<Service>(
    const ServiceContext& context, ExperimentController& controller, std::function<void()> done)>;

/// The recorded reason when a procedure ended the run.
inline constexpr const char* kProcedureDone = "the calibration procedure is done";

/// A procedure and its node. Its messages name the sender "calibration".
class ProcedureNode {
 public:
  ProcedureNode(Bus& bus, Loop& loop, Cameras& cameras, const PreparedRun& run,
                std::int64_t instance, const ProcedureFactory& make,
                ExperimentController& controller, std::function<void()> done)
      : node_(bus, loop, {"calibration", 0, instance}),
        procedure_(make({.node = node_,
                         .loop = loop,
                         .experiment = run.experiment,
                         .directory = run.directory,
                         .cameras = cameras},
                        controller, std::move(done))) {}

  void begin() {
    node_.start();
    node_.ready();
  }
  void end() { node_.close(); }

 private:
  Node node_;
  std::unique_ptr<Service> procedure_;
};

}  // namespace lab::runner
