#include "tests/dds_gateway/ros/type_description.hpp"

#include <algorithm>
#include <cstdint>
#include <regex>
#include <set>
#include <span>
#include <sstream>
#include <stdexcept>

#include "light/field/image.hpp"

namespace lab::ros {
namespace {

/// Values of type_description_interfaces/msg/FieldType; arrays and sequences have an offset.
const std::map<std::string, int> kIds = {
    {"int8", 2},   {"uint8", 3}, {"int16", 4},  {"uint16", 5},   {"int32", 6},
    {"uint32", 7}, {"int64", 8}, {"uint64", 9}, {"float32", 10}, {"float64", 11},
    {"bool", 15},  {"byte", 16}, {"string", 17}};
constexpr int kNested = 1;
constexpr int kArray = 48;
constexpr int kSequence = 144;

const std::map<std::string, std::string> kMsgNameOfIdl = {
    {"boolean", "bool"}, {"octet", "byte"}, {"float", "float32"}, {"double", "float64"}};

std::string fieldJson(const Field& field) {
  const auto basic = kIds.find(field.type);
  const bool nested = basic == kIds.end();
  const int id = (nested ? kNested : basic->second) +
                 (field.sequence ? kSequence : (field.array > 0 ? kArray : 0));
  return R"({"name": ")" + field.name + R"(", "type": {"type_id": )" + std::to_string(id) +
         R"(, "capacity": )" + std::to_string(field.array) +
         R"(, "string_capacity": 0, "nested_type_name": ")" + (nested ? field.type : "") + "\"}}";
}

std::string json(const Definitions& definitions, const std::string& message) {
  std::string fields;
  for (const Field& field : definitions.at(message)) {
    fields += (fields.empty() ? "" : ", ") + fieldJson(field);
  }
  return R"({"type_name": ")" + message + R"(", "fields": [)" + fields + "]}";
}

void collect(const Definitions& definitions, const std::string& message,
             std::set<std::string>& referenced) {
  for (const Field& field : definitions.at(message)) {
    if (kIds.contains(field.type) || !referenced.insert(field.type).second) continue;
    collect(definitions, field.type, referenced);
  }
}

}  // namespace

std::string typeHash(const Definitions& definitions, const std::string& message) {
  std::set<std::string> referenced;
  collect(definitions, message, referenced);
  std::string others;
  for (const std::string& name : referenced) {
    others += (others.empty() ? "" : ", ") + json(definitions, name);
  }
  const std::string text = R"({"type_description": )" + json(definitions, message) +
                           R"(, "referenced_type_descriptions": [)" + others + "]}";
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  return "RIHS01_" + light::sha256(bytes);
}

Definitions fromIdl(const std::string& text) {
  static const std::regex module(R"(\s*module (\w+) \{ module msg \{ module dds_ \{)");
  static const std::regex begin(R"(\s*@final @(?:topic|nested) struct (\w+)_ \{)");
  static const std::regex member(R"(\s*(sequence<)?([\w:]+)>? (\w+)(?:\[(\d+)\])?;)");
  static const std::regex nothing(R"(\s*(?://.*|\};(?:\};\};)?)?)");
  static const std::regex foreign(R"((\w+)::msg::dds_::(\w+)_)");
  Definitions all;
  std::string package;
  std::string message;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (std::regex_match(line, found, module)) {
      package = found[1];
    } else if (std::regex_match(line, found, begin)) {
      message = package + "/msg/" + found[1].str();
      all[message];
    } else if (std::regex_match(line, found, member)) {
      const std::string idl = found[2];
      const auto renamed = kMsgNameOfIdl.find(idl);
      std::string type = renamed == kMsgNameOfIdl.end() ? idl : renamed->second;
      std::smatch where;
      if (std::regex_match(idl, where, foreign)) {
        type = where[1].str() + "/msg/" + where[2].str();
      } else if (!kIds.contains(type)) {
        type = package + "/msg/" + idl.substr(0, idl.size() - 1);
      }
      all[message].push_back(
          {found[3], type, found[1].matched, found[4].matched ? std::stoi(found[4]) : 0});
    } else if (!std::regex_match(line, nothing)) {
      throw std::runtime_error("not understood: " + line);
    }
  }
  return all;
}

std::vector<Field> fromMsg(const std::string& text, const std::string& package) {
  static const std::regex member(R"(\s*([\w/]+)(\[(\d*)\])?\s+(\w+)\s*(?:#.*)?)");
  static const std::regex nothing(R"(\s*(?:\w+ \w+=-?\d+\s*)?(?:#.*)?)");
  std::vector<Field> fields;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (std::regex_match(line, nothing)) continue;
    if (!std::regex_match(line, found, member)) throw std::runtime_error("not understood: " + line);
    std::string type = found[1];
    if (const auto slash = type.find('/'); slash != std::string::npos) {
      type.insert(slash, "/msg");
    } else if (!kIds.contains(type)) {
      type = package + "/msg/" + type;
    }
    const bool bounded = found[3].length() > 0;
    fields.push_back(
        {found[4], type, found[2].matched && !bounded, bounded ? std::stoi(found[3]) : 0});
  }
  return fields;
}

}  // namespace lab::ros
