// Messages as tables and in ROS 2's encoding, and files of other programs. The first byte selects:
// `c` a byte for the type and CDR; `m` an MCAP file; anything else a message in LCM's encoding,
// without its fingerprint, after a byte for the type.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/schema/array_groups.hpp"
#include "common/schema/message_table.hpp"
#include "common/schema/ros_encoding.hpp"
#include "common/schema/schema.hpp"
#include "runner/export/mcap_reader.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/fuzz/memory_file.hpp"

namespace lab::fuzz {
namespace {

const schema::Type& typeOf(std::uint8_t number) {
  const auto& types = schema::messageSchema().types();
  return *types[number % types.size()];
}

/// A message that is converted is the same after the way back.
void convert(const schema::Type& type, Bytes encoding) {
  const auto cdr = schema::toCdr(type, encoding);
  for (const std::string& path : schema::tablePaths(type)) {
    schema::MessageTable table(type, path);
    require(table.take(0, 0, encoding) == cdr.has_value());
  }
  if (!cdr) return;
  const auto back = schema::fromCdr(type, *cdr);
  require(back && std::equal(back->begin(), back->end(), encoding.begin(), encoding.end()));
}

void readMcap(std::span<const std::uint8_t> bytes) {
  const MemoryFile file(bytes.data(), bytes.size());
  try {
    runner::mcap::read(file.path(), [](const runner::mcap::Message& message) {
      if (const schema::Type* type = schema::typeOfRosName(message.schema)) {
        static_cast<void>(schema::fromCdr(
            *type,
            {reinterpret_cast<const std::uint8_t*>(message.data.data()), message.data.size()}));
      }
    });
  } catch (const std::runtime_error&) {
  }
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lab;
  if (size < 2) return 0;
  const std::span<const std::uint8_t> rest(data + 2, size - 2);
  if (data[0] == 'm') {
    fuzz::readMcap({data + 1, size - 1});
  } else if (data[0] == 'c') {
    static_cast<void>(schema::fromCdr(fuzz::typeOf(data[1]), rest));
  } else {
    const schema::Type& type = fuzz::typeOf(data[1]);
    std::vector<std::uint8_t> encoding;
    for (int shift = 56; shift >= 0; shift -= 8) {
      encoding.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(type.hash) >> shift));
    }
    encoding.insert(encoding.end(), rest.begin(), rest.end());
    fuzz::convert(type, encoding);
  }
  return 0;
}
