// Compiles the implementations of the stb headers. Of the decoders only those for images of the
// light (image.cpp) and pictures of cameras (docs/cameras.md): files may come from a stranger.
#define STBI_ONLY_BMP
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_ONLY_PNM  // PGM and PPM
#define STBI_ONLY_TGA  // pictures of cameras only
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_RESIZE_IMPLEMENTATION
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image.h>
#include <stb/stb_image_resize.h>
#include <stb/stb_image_write.h>
