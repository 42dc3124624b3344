/// A Cyclone type whose samples are unchecked payloads, as in rmw_cyclonedds, so that tests can
/// send any bytes.
#pragma once

#include <dds/dds.h>

#include <string>
#include <vector>

#include "tests/dds_gateway/peers/peer_loop.hpp"

namespace lab::dds {

/// @return a topic, or an error code
[[nodiscard]] dds_entity_t rawTopic(dds_entity_t participant, const std::string& topic,
                                    const std::string& type);

/// Takes all samples that have arrived at a reader of such a topic.
[[nodiscard]] std::vector<Payload> takeRaw(dds_entity_t reader);

/// Writes a payload. @return as dds_write()
dds_return_t writeRaw(dds_entity_t writer, const Payload& payload);

}  // namespace lab::dds
