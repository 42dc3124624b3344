#include "common/bus/fingerprints.hpp"

#include <array>
#include <cstdio>

#include "common/bus/all_messages.hpp"

namespace lab {
namespace {

struct Type {
  std::string_view name;
  std::int64_t hash;
};

template <class... Messages>
std::array<Type, sizeof...(Messages)> typesOf(MessageList<Messages...> /*all*/) {
  return {Type{Messages::getTypeName(), Messages::getHash()}...};
}

const auto& allTypes() {
  static const auto all = typesOf(AllMessages{});
  return all;
}

}  // namespace

std::string fingerprintList() {
  std::string list;
  for (const Type& type : allTypes()) list += fingerprintLine(type.name, type.hash);
  return list;
}

std::string fingerprintLine(std::string_view type, std::int64_t hash) {
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(hash));
  return std::string(type) + " " + digits.data() + "\n";
}

std::string_view typeWithFingerprint(std::int64_t hash) {
  for (const Type& type : allTypes()) {
    if (type.hash == hash) return type.name;
  }
  return {};
}

}  // namespace lab
