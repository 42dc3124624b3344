/// The Huffman tables that cameras leave out of their JPEGs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lab::cameras {

/// The JPEG with the tables of ITU-T T.81, annex K.3, before its scan, unless it has tables of its
/// own. (USB video class cameras may omit them.)
[[nodiscard]] std::vector<std::uint8_t> withHuffmanTables(std::span<const std::uint8_t> jpeg);

}  // namespace lab::cameras
