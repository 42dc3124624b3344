#include "robot/wire/schema.hpp"

#include <gtest/gtest.h>

#include <iomanip>
#include <string>

namespace lab::wire {
namespace {

TEST(Schema, EqualsThePinnedValue) {
  EXPECT_EQ(schema(), kSchema)
      << "The messages have changed, so that older robots and hosts are incompatible.\n"
      << "If this is intended: write 0x" << std::hex << std::uppercase << std::setw(4)
      << std::setfill('0') << schema() << " as kSchema into robot/wire/messages.hpp, "
      << "update docs/protocol.md, and flash the robots.";
}

}  // namespace
}  // namespace lab::wire
