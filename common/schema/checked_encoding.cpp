#include "common/schema/checked_encoding.hpp"

#include <algorithm>
#include <array>

#include "common/bus/all_messages.hpp"
#include "common/bus/message_values.hpp"
#include "common/schema/schema.hpp"

namespace lab::schema {
namespace {

template <class Message>
CheckedEncoding checkedAs(Bytes encoding) {
  CheckedEncoding checked;
  Message message{};
  checked.decoded = decode(encoding, message);
  if (!checked.decoded) {
    checked.problem = std::string("the bytes are no ") + Message::getTypeName();
    return checked;
  }
  const auto found = removeImpossible(message);
  checked.usable = !found || found->usable;
  if (!found) return checked;
  checked.problem = found->first;
  if (!found->usable) return checked;
  checked.removed = found->count;
  checked.remaining = encode(message);
  return checked;
}

struct Check {
  std::int64_t hash;
  CheckedEncoding (*check)(Bytes);
};

template <class... Messages>
std::array<Check, sizeof...(Messages)> checksOf(MessageList<Messages...> /*all*/) {
  return {Check{Messages::getHash(), &checkedAs<Messages>}...};
}

const auto& allChecks() {
  static const auto all = checksOf(AllMessages{});
  return all;
}

}  // namespace

CheckedEncoding checkEncoding(Bytes encoding) {
  const std::int64_t hash = fingerprintOf(encoding.data(), encoding.size());
  const auto found = std::ranges::find(allChecks(), hash, &Check::hash);
  if (found == allChecks().end()) {
    CheckedEncoding unknown;
    unknown.problem = "the message is of a type that this version does not know";
    return unknown;
  }
  return found->check(encoding);
}

}  // namespace lab::schema
