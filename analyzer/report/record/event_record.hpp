/// Collects the events of a run and the status of its services.
#pragma once

#include <cstdint>
#include <lab/experiment_event_t.hpp>
#include <lab/service_status_t.hpp>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "analyzer/report/record/run_record.hpp"

namespace lab::report {

/// Collects EXPERIMENT_EVENT. Events are sent several times because LCM may drop messages; each
/// counts once.
class EventRecord {
 public:
  void take(const experiment_event_t& event);

  /// Fills in steps, faults, marks, start and end.
  void finish(RunRecord& record) const;

 private:
  void takeStep(const experiment_event_t& event);

  std::set<std::tuple<std::int64_t, std::int8_t, std::string>> known_;
  std::map<int, StepRecord> steps_;
  std::vector<Remark> faults_;
  std::vector<Remark> marks_;
  std::int64_t left_out_ = 0;  ///< messages of marks and faults beyond the limits
  std::int64_t start_utime_ = 0;
  std::int64_t end_utime_ = 0;
  std::string end_reason_;
  std::string light_calibration_;  ///< text of the calibration file
  std::string version_;
  int contract_version_ = 0;
};

/// Collects SERVICE_STATUS.
class ServiceRecords {
 public:
  void take(const service_status_t& status);
  void finish(RunRecord& record) const;

 private:
  std::vector<std::pair<std::int64_t, ServiceRecord>>
      services_;                                  ///< with the instance of each start
  std::map<std::string, service_status_t> last_;  ///< by name
};

}  // namespace lab::report
