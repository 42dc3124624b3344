#include "common/schema/schema.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/schema/array_groups.hpp"
#include "common/schema/message_table.hpp"
#include "tests/lcmtypes/contract.hpp"

namespace lab::schema {
namespace schema_test {

TEST(Schema, HasTheFingerprintOfEveryType) {
  std::set<std::string> names;

  const auto check = [&]<class Message>() {
    const Type* type = messageSchema().find(Message::getTypeName());
    ASSERT_NE(type, nullptr) << Message::getTypeName();
    EXPECT_EQ(type->hash, Message::getHash()) << type->name;
    EXPECT_EQ(messageSchema().findHash(Message::getHash()), type);
    names.insert(type->name);
  };
  forEachType(ChannelTypes{}, check);
  forEachType(PartTypes{}, check);

  EXPECT_EQ(names.size(), messageSchema().types().size());
}

TEST(Schema, KnowsTheSizeOfTypesWithoutTextsAndLists) {
  tracked_pose_t pose{};
  const Type* type = messageSchema().find("tracked_pose_t");
  ASSERT_NE(type, nullptr);
  EXPECT_EQ(type->fixed_bytes + sizeof(std::int64_t),
            static_cast<std::size_t>(pose.getEncodedSize()));
  EXPECT_EQ(messageSchema().find("robot_state_t")->fixed_bytes, 0U);
}

TEST(Schema, SeparatesUnitsFromComments) {
  const Type* type = messageSchema().find("experiment_event_t");
  ASSERT_NE(type, nullptr);
  const Field& commanded = type->fields[static_cast<std::size_t>(type->indexOf("commanded_utime"))];
  EXPECT_EQ(commanded.unit, "us since 1970");
  EXPECT_EQ(commanded.comment, "(STEP)");
  const Field& kind = type->fields[static_cast<std::size_t>(type->indexOf("kind"))];
  ASSERT_EQ(kind.constants.size(), 6U);
  EXPECT_EQ(kind.constants[2].name, "FAULT");
  EXPECT_EQ(kind.constants[2].value, "3");
  EXPECT_EQ(kind.constants[2].comment, "text: what failed; the run is marked as faulty");
}

TEST(Schema, RefusesWhatItDoesNotUnderstand) {
  const auto parse = [](const std::string& text) { return Schema({text}); };
  EXPECT_THROW(parse("package a;\nstruct b_t {\n  int32_t x\n}\n"), std::invalid_argument);
  EXPECT_THROW(parse("package a;\nstruct b_t {\n  int32_t x[n];\n}\n"), std::invalid_argument);
  EXPECT_THROW(parse("package a;\nstruct b_t {\n  other_t x;\n}\n"), std::invalid_argument);
  EXPECT_THROW(parse("package a;\nstruct b_t {\n  int32_t x;\n"), std::invalid_argument);
  EXPECT_NO_THROW(parse("package a;\nstruct b_t {\n  int32_t n;\n  int8_t x[n];\n}\n"));
}

TEST(ArrayGroups, ListsOfOneLengthAreOneTable) {
  const std::vector<ArrayGroup> groups = arrayGroups(*messageSchema().find("curve_t"));
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(groups.front().name, "lags");
  EXPECT_EQ(groups.front().fields.size(), 7U);
  EXPECT_EQ(arrayGroups(*messageSchema().find("robot_order_t")).front().name, "robot_ids");
}

// Column names and file names are made of these.
TEST(ArrayGroups, PathsAreUniqueAlsoWithUnderscores) {
  for (const auto& type : messageSchema().types()) {
    std::set<std::string> names;
    for (std::string path : tablePaths(*type)) {
      std::ranges::replace(path, '.', '_');
      EXPECT_TRUE(names.insert(path).second) << type->name << " " << path;
      EXPECT_NE(path, "messages");
    }
  }
}

TEST(MessageTable, HasDifferentColumnsInEveryTableOfEveryType) {
  for (const auto& type : messageSchema().types()) {
    for (const std::string& path : tablePaths(*type)) {
      EXPECT_NO_THROW(static_cast<void>(MessageTable::allColumns(*type, path)))
          << type->name << " " << path;
    }
  }
}

}  // namespace schema_test
}  // namespace lab::schema
