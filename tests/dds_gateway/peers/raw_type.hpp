/// A type of Cyclone whose samples are payloads as they are on the wire, as rmw_cyclonedds has one:
/// nothing is checked, so that anything can be sent.
#pragma once

#include <dds/dds.h>

#include <string>
#include <vector>

#include "tests/dds_gateway/peers/peer_loop.hpp"

namespace lab::dds {

/// @return a topic, or an error code
[[nodiscard]] dds_entity_t rawTopic(dds_entity_t participant, const std::string& topic,
                                    const std::string& type);

/// Of a reader of such a topic, all that has arrived.
[[nodiscard]] std::vector<Payload> takeRaw(dds_entity_t reader);

/// @return as dds_write()
dds_return_t writeRaw(dds_entity_t writer, const Payload& payload);

}  // namespace lab::dds
