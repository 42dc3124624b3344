# Writes FILE, a C++ source that says which commit of SOURCE is built; empty where git does not know.
execute_process(COMMAND git -C "${SOURCE}" rev-parse --short=12 HEAD
  OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(revision "")
endif()
file(CONFIGURE OUTPUT "${FILE}" @ONLY CONTENT [[
#include "runner/revision.hpp"

namespace lab::runner {

std::string sourceRevision() { return "@revision@"; }

}  // namespace lab::runner
]])
