/// Owner of pixels decoded by stb.
#pragma once

#include <stb/stb_image.h>

#include <memory>

namespace lab::cameras {

struct StbFree {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};
using StbPixels = std::unique_ptr<stbi_uc, StbFree>;

}  // namespace lab::cameras
