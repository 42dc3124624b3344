# Writes FILE, a C++ source with the commit of SOURCE and its date; empty strings outside a git clone.
execute_process(COMMAND git -C "${SOURCE}" rev-parse --short=12 HEAD
  OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(revision "")
endif()
set(ENV{TZ} UTC)
execute_process(COMMAND git -C "${SOURCE}" log -1 --format=%cd "--date=format-local:%Y-%m-%d %H:%M:%S UTC"
  OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(date "")
endif()
file(CONFIGURE OUTPUT "${FILE}" @ONLY CONTENT [[
#include "runner/command_line/revision.hpp"

namespace lab::runner {

std::string sourceRevision() { return "@revision@"; }

std::string sourceDate() { return "@date@"; }

}  // namespace lab::runner
]])
