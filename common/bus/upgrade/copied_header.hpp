/// The header of messages of older contract versions.
#pragma once

namespace lab {

/// A message of the present version with the header of an old one.
template <class New, class Old>
[[nodiscard]] New withHeaderOf(const Old& old) {
  New message{};
  message.utime = old.utime;
  message.sender = old.sender;
  message.instance = old.instance;
  message.seq = old.seq;
  return message;
}

}  // namespace lab
