#include "robot/wire/schema.hpp"

#include <gtest/gtest.h>

#include <iomanip>
#include <string>

namespace lab::wire {
namespace {

TEST(Schema, IsTheOnePinnedInTheMessages) {
  EXPECT_EQ(schema(), kSchema)
      << "the messages changed: robots and hosts built before no longer understand each other.\n"
      << "If that is meant: write 0x" << std::hex << std::uppercase << std::setw(4)
      << std::setfill('0') << schema() << " as kSchema into robot/wire/messages.hpp, bring "
      << "docs/protocol.md up to date, and flash the robots.";
}

}  // namespace
}  // namespace lab::wire
