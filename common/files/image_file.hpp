/// Images of light fields, read from files.
#pragma once

#include <filesystem>

#include "light/field/image.hpp"

namespace lab {

/// light::decodeImage() of a regular file; an error begins with the path.
[[nodiscard]] light::DecodedImage loadImage(const std::filesystem::path& path);

}  // namespace lab
