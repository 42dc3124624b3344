/// A hash that is the same on every host and in every version.
#pragma once

#include <cstdint>
#include <string_view>

namespace lab {

/// FNV-1a, 64 bit: for comparing texts for equality, not against forgery.
[[nodiscard]] constexpr std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char byte : text) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
  return hash;
}

}  // namespace lab
