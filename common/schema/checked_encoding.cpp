#include "common/schema/checked_encoding.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <type_traits>
#include <utility>

#include "common/bus/all_messages.hpp"
#include "common/bus/message_header.hpp"
#include "common/bus/message_sizes.hpp"
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

template <class Message>
CheckedEncoding checkedAsReceived(Bytes encoding) {
  CheckedEncoding refused;
  if (auto problem = tooLarge<Message>(encoding)) {
    refused.problem = std::move(*problem);
    return refused;
  }
  if constexpr (!std::is_same_v<Message, robot_stop_t>) {  // which is obeyed whatever it holds
    if (auto sender = peekLongSender(encoding)) {
      refused.problem = std::move(sender->problem);
      return refused;
    }
  }
  return checkedAs<Message>(encoding);
}

using CheckFunction = CheckedEncoding (*)(Bytes);

struct Check {
  std::int64_t hash;
  CheckFunction logged;
  CheckFunction received;
};

template <class... Messages>
std::array<Check, sizeof...(Messages)> checksOf(MessageList<Messages...> /*all*/) {
  return {Check{Messages::getHash(), &checkedAs<Messages>, &checkedAsReceived<Messages>}...};
}

const auto& allChecks() {
  static const auto all = checksOf(AllMessages{});
  return all;
}

CheckedEncoding checkBy(CheckFunction Check::*function, Bytes encoding) {
  const std::int64_t hash = fingerprintOf(encoding.data(), encoding.size());
  const auto found = std::ranges::find(allChecks(), hash, &Check::hash);
  if (found == allChecks().end()) {
    CheckedEncoding unknown;
    unknown.problem = "the message is of a type that this version does not know";
    return unknown;
  }
  return ((*found).*function)(encoding);
}

}  // namespace

CheckedEncoding checkEncoding(Bytes encoding) { return checkBy(&Check::logged, encoding); }

CheckedEncoding checkReceived(Bytes encoding) { return checkBy(&Check::received, encoding); }

}  // namespace lab::schema
