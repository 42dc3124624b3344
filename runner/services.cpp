#include "runner/services.hpp"

#include "analyzer/analyzer_service.hpp"
#include "projector_ctl/projector_service.hpp"
#include "sim_svc/sim_service.hpp"

namespace lab::runner {

std::vector<ServiceDescription> labServices() {
  return {analysis::serviceDescription(), projector::serviceDescription(),
          sim::serviceDescription()};
}

}  // namespace lab::runner
