/// Limits of TOML texts that may come from others.
#pragma once

#include <cstddef>
#include <string_view>

namespace lab::keys {

/// Names in one key, as in a.b.c = 1 and [a.b.c]; more than any file of the lab has. toml++ limits
/// the depth of arrays and inline tables itself, but handles tables within tables by recursion.
constexpr std::size_t kMostNames = 32;

/// The line of the first key of more than kMostNames names, which are separated by dots.
/// @return counted from 1; 0: there is no such key
[[nodiscard]] std::size_t lineOfDeepKey(std::string_view toml);

}  // namespace lab::keys
