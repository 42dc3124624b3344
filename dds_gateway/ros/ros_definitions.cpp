#include "dds_gateway/ros/ros_definitions.hpp"

#include <algorithm>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace lab::ros {
namespace {

/// Of IDL's basic types those with another name in .msg files.
const std::map<std::string, std::string> kBasic = {
    {"boolean", "bool"},  {"octet", "byte"},    {"float", "float32"}, {"double", "float64"},
    {"int8", "int8"},     {"uint8", "uint8"},   {"int16", "int16"},   {"uint16", "uint16"},
    {"int32", "int32"},   {"uint32", "uint32"}, {"int64", "int64"},   {"uint64", "uint64"},
    {"string", "string"},
};

/// "geometry_msgs::msg::dds_::Pose_", or "Pose_" of the same package -> "geometry_msgs/Pose".
std::string msgTypeName(const std::string& idl, const std::string& package) {
  if (const auto basic = kBasic.find(idl); basic != kBasic.end()) return basic->second;
  const std::size_t first = idl.find("::");
  const std::size_t last = idl.rfind(':');
  const std::string name = first == std::string::npos ? idl : idl.substr(last + 1);
  return (first == std::string::npos ? package : idl.substr(0, first)) + "/" +
         name.substr(0, name.size() - 1);
}

/// "geometry_msgs/Pose" -> "geometry_msgs/msg/Pose"
std::string fullName(std::string type) { return type.insert(type.find('/'), "/msg"); }

void collectParts(const MsgDefinitions& all, const std::string& name,
                  std::vector<std::string>& parts) {
  for (const MsgField& field : all.at(name)) {
    if (field.type.find('/') == std::string::npos) continue;
    if (std::ranges::find(parts, field.type) != parts.end()) continue;
    parts.push_back(field.type);
    collectParts(all, fullName(field.type), parts);
  }
}

std::string msgFile(const std::vector<MsgField>& fields) {
  std::string text;
  for (const MsgField& field : fields) {
    text += field.type;
    if (field.sequence) text += "[]";
    if (field.array > 0) text += "[" + std::to_string(field.array) + "]";
    text += " " + field.name + "\n";
  }
  return text;
}

}  // namespace

MsgDefinitions readIdl(const std::string& text) {
  static const std::regex module(R"(\s*module (\w+) \{ module msg \{ module dds_ \{)");
  static const std::regex begin(R"(\s*@final @(?:topic|nested) struct (\w+)_ \{)");
  static const std::regex member(R"(\s*(sequence<)?([\w:]+)>? (\w+)(?:\[(\d+)\])?;)");
  static const std::regex nothing(R"(\s*(?://.*|\};(?:\};\};)?)?)");
  MsgDefinitions all;
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
      all[message].push_back({found[3], msgTypeName(found[2], package), found[1].matched,
                              found[4].matched ? std::stoi(found[4]) : 0});
    } else if (!std::regex_match(line, nothing)) {
      throw std::invalid_argument("messages.idl: found \"" + line +
                                  "\", expected a module, a struct or a member");
    }
  }
  return all;
}

std::string msgDefinition(const std::string& name) {
  static const MsgDefinitions all = readIdl(messagesIdl());
  std::string text = msgFile(all.at(name));
  std::vector<std::string> parts;
  collectParts(all, name, parts);
  for (const std::string& part : parts) {
    text += std::string(80, '=') + "\nMSG: " + part + "\n" + msgFile(all.at(fullName(part)));
  }
  return text;
}

}  // namespace lab::ros
