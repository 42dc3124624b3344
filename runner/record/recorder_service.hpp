/// The recorder of a run in real time: everything on the bus into a log, as the stock lcm-logger
/// writes it. It receives with LcmBus, so what the bus refuses is neither recorded nor can it end
/// the recording.
#pragma once

#include "common/service/service_main.hpp"

namespace lab::runner {

/// The service `recorder --log FILE`. A log is never overwritten. What was recorded is in the file
/// after 0.1 s. It ends when its own last heartbeat is recorded, with one line of counts on stderr;
/// if the disk is full, with a fault and exit code 1.
[[nodiscard]] ServiceDescription recorderDescription();

}  // namespace lab::runner
