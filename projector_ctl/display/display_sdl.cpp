#include "projector_ctl/display/display_sdl.hpp"

#include <SDL2/SDL.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "light/field/target_clones.hpp"

namespace lab::projector {

namespace {

constexpr std::uint32_t kOpaque = 0xFF000000;

/// Initialises SDL's video for the lifetime of the object. SDL must not handle SIGTERM, which the
/// service needs, nor minimise the window when it loses the focus.
class Video {
 public:
  Video() {
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_VIDEO_MINIMIZE_ON_FOCUS_LOSS, "0");
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
    const bool works = SDL_InitSubSystem(SDL_INIT_VIDEO) == 0;
    const std::string found = works ? SDL_GetCurrentVideoDriver() : SDL_GetError();
    // Without a desktop, SDL falls back to drivers that show nothing.
    const bool seen = works && found != "dummy" && found != "offscreen" && found != "evdev";
    if (seen || (works && SDL_getenv("SDL_VIDEODRIVER") != nullptr)) return;
    if (works) SDL_QuitSubSystem(SDL_INIT_VIDEO);
    throw DisplayError(
        fmt::format("no desktop to open a window on (SDL: {}); set DISPLAY, as in "
                    "DISPLAY=:0, or projector.display = \"headless\"",
                    found));
  }
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;
  ~Video() { SDL_QuitSubSystem(SDL_INIT_VIDEO); }
};

std::vector<DisplayInfo> displays() {
  std::vector<DisplayInfo> found;
  for (int number = 0; number < SDL_GetNumVideoDisplays(); ++number) {
    SDL_Rect bounds{};
    SDL_DisplayMode mode{};
    if (SDL_GetDisplayBounds(number, &bounds) != 0) continue;
    const char* name = SDL_GetDisplayName(number);
    DisplayInfo info{number, name != nullptr ? name : "", bounds.x, bounds.y, bounds.w, bounds.h};
    if (SDL_GetDesktopDisplayMode(number, &mode) == 0) info.refresh_rate = mode.refresh_rate;
    found.push_back(std::move(info));
  }
  return found;
}

DisplayInfo choose(const std::string& name_or_number) {
  const std::vector<DisplayInfo> found = displays();
  const auto is_wanted = [&](const DisplayInfo& info) {
    return info.name == name_or_number || std::to_string(info.number) == name_or_number;
  };
  const auto matches = std::count_if(found.begin(), found.end(), is_wanted);
  if (matches == 1) return *std::find_if(found.begin(), found.end(), is_wanted);
  throw DisplayError(
      fmt::format("projector.display = \"{}\": {} displays have that name or number, "
                  "expected one of\n{}",
                  name_or_number, matches, describe(found)));
}

std::optional<DisplayEvent> arrow(SDL_Keycode key, bool fast) {
  switch (key) {
    case SDLK_LEFT:
      return fast ? DisplayEvent::kFastLeft : DisplayEvent::kLeft;
    case SDLK_RIGHT:
      return fast ? DisplayEvent::kFastRight : DisplayEvent::kRight;
    case SDLK_UP:
      return fast ? DisplayEvent::kFastUp : DisplayEvent::kUp;
    case SDLK_DOWN:
      return fast ? DisplayEvent::kFastDown : DisplayEvent::kDown;
    default:
      return {};
  }
}

std::optional<DisplayEvent> keyEvent(const SDL_KeyboardEvent& key) {
  switch (key.keysym.sym) {
    case SDLK_ESCAPE:
      return key.repeat != 0 ? std::optional<DisplayEvent>{} : DisplayEvent::kEscape;
    case SDLK_o:
      return DisplayEvent::kOverlay;
    case SDLK_TAB:
      return DisplayEvent::kTab;
    case SDLK_RETURN:
    case SDLK_KP_ENTER:
      return DisplayEvent::kEnter;
    default:
      return arrow(key.keysym.sym, (key.keysym.mod & KMOD_SHIFT) != 0);
  }
}

LAB_TARGET_CLONES
void toPixels(const std::uint8_t* grey, std::size_t count, std::uint32_t* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = kOpaque | (grey[i] * 0x010101U);
}

void copyBox(const optics::GreyView& picture, const Box& box, void* pixels, int pitch) {
  for (int y = box.y; y < box.y + box.height; ++y) {
    auto* const row = static_cast<unsigned char*>(pixels) + std::ptrdiff_t{y} * pitch;
    toPixels(picture.row(y) + box.x, static_cast<std::size_t>(box.width),
             reinterpret_cast<std::uint32_t*>(row) + box.x);
  }
}

/// Whether the renderer is a graphics card. A software renderer is slower than drawing through
/// shared memory.
bool isCard(SDL_Renderer* renderer) {
  SDL_RendererInfo info{};
  if (SDL_GetRendererInfo(renderer, &info) != 0) return false;
  if ((info.flags & SDL_RENDERER_ACCELERATED) == 0) return false;
  if (std::string_view(info.name).substr(0, 6) != "opengl") return true;
  using GetString = const unsigned char* (*)(unsigned);
  constexpr unsigned kRenderer = 0x1F01;  // GL_RENDERER
  GetString get = nullptr;
  void* const symbol = SDL_GL_GetProcAddress("glGetString");
  std::memcpy(&get, &symbol, sizeof get);
  const unsigned char* text = get != nullptr ? get(kRenderer) : nullptr;
  const std::string_view name = text != nullptr ? reinterpret_cast<const char*>(text) : "";
  return !name.empty() && name.find("llvmpipe") == name.npos &&
         name.find("softpipe") == name.npos && name.find("Software") == name.npos;
}

class SdlDisplay final : public Display {
 public:
  explicit SdlDisplay(const std::string& name_or_number) : info_(choose(name_or_number)) {
    openWindow();
    renderer_ =
        SDL_CreateRenderer(window_, -1, SDL_RENDERER_ACCELERATED | SDL_RENDERER_PRESENTVSYNC);
    if (renderer_ != nullptr && isCard(renderer_)) {
      texture_ = SDL_CreateTexture(renderer_, SDL_PIXELFORMAT_ARGB8888, SDL_TEXTUREACCESS_STREAMING,
                                   info_.width, info_.height);
      void* const symbol = SDL_GL_GetProcAddress("glFinish");
      std::memcpy(&finish_, &symbol, sizeof finish_);
      pixels_.resize(static_cast<std::size_t>(info_.width) *
                     static_cast<std::size_t>(info_.height));
    }
    if (texture_ == nullptr) {
      close();
      openWindow();
      if (SDL_GetWindowSurface(window_) == nullptr) fail("no picture in the window");
    }
    SDL_ShowCursor(SDL_DISABLE);
    SDL_DisableScreenSaver();
    SDL_RaiseWindow(window_);
  }

  SdlDisplay(const SdlDisplay&) = delete;
  SdlDisplay& operator=(const SdlDisplay&) = delete;
  ~SdlDisplay() override { close(); }

  [[nodiscard]] const DisplayInfo& info() const override { return info_; }
  [[nodiscard]] bool mayWait() const override { return texture_ != nullptr; }

  void present(const optics::GreyView& picture, std::span<const Box> changed) override {
    std::vector<SDL_Rect> boxes;
    boxes.reserve(changed.size());
    for (const Box& box : changed) boxes.push_back({box.x, box.y, box.width, box.height});
    if (texture_ != nullptr) {
      presentByCard(picture, changed, boxes);
      return;
    }
    SDL_Surface* const surface = SDL_GetWindowSurface(window_);
    if (surface == nullptr || surface->w != info_.width || surface->h != info_.height ||
        surface->format->BytesPerPixel != sizeof(std::uint32_t)) {
      fail("the window has lost its picture");
    }
    if (surface != surface_ || exposed_) {
      const Box whole{0, 0, info_.width, info_.height};
      copyBox(picture, whole, surface->pixels, surface->pitch);
      boxes.assign(1, {0, 0, info_.width, info_.height});
    } else {
      for (const Box& box : changed) copyBox(picture, box, surface->pixels, surface->pitch);
    }
    if (boxes.empty()) return;
    if (SDL_UpdateWindowSurfaceRects(window_, boxes.data(), static_cast<int>(boxes.size())) != 0) {
      fail("the window cannot be updated");
    }
    surface_ = surface;
    exposed_ = false;
  }

  [[nodiscard]] std::vector<DisplayEvent> events() override {
    std::vector<DisplayEvent> happened;
    SDL_Event event{};
    while (SDL_PollEvent(&event) != 0) {
      if (const auto meaning = meaningOf(event)) happened.push_back(*meaning);
      // Parts that another window covered must be drawn again.
      exposed_ = exposed_ ||
                 (event.type == SDL_WINDOWEVENT && event.window.event == SDL_WINDOWEVENT_EXPOSED);
    }
    return happened;
  }

 private:
  void openWindow() {
    const auto place = static_cast<int>(SDL_WINDOWPOS_UNDEFINED_MASK) | info_.number;
    window_ = SDL_CreateWindow("projector_ctl", place, place, info_.width, info_.height,
                               SDL_WINDOW_FULLSCREEN_DESKTOP | SDL_WINDOW_BORDERLESS);
    if (window_ == nullptr) fail("no window");
  }

  [[noreturn]] void fail(const char* what) const {
    throw DisplayError(
        fmt::format("display {} \"{}\": {} ({})", info_.number, info_.name, what, SDL_GetError()));
  }

  void close() {
    if (texture_ != nullptr) SDL_DestroyTexture(texture_);
    if (renderer_ != nullptr) SDL_DestroyRenderer(renderer_);
    if (window_ != nullptr) SDL_DestroyWindow(window_);
    texture_ = nullptr;
    renderer_ = nullptr;
    window_ = nullptr;
  }

  void presentByCard(const optics::GreyView& picture, std::span<const Box> changed,
                     const std::vector<SDL_Rect>& boxes) {
    const int pitch = info_.width * static_cast<int>(sizeof(std::uint32_t));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      copyBox(picture, changed[i], pixels_.data(), pitch);
      const std::size_t at =
          static_cast<std::size_t>(boxes[i].y) * static_cast<std::size_t>(info_.width) +
          static_cast<std::size_t>(boxes[i].x);
      if (SDL_UpdateTexture(texture_, &boxes[i], &pixels_[at], pitch) != 0) fail("no texture");
    }
    if (SDL_RenderCopy(renderer_, texture_, nullptr, nullptr) != 0) fail("no picture");
    SDL_RenderPresent(renderer_);
    // A driver may queue pictures; wait for the actual swap.
    if (finish_ != nullptr) finish_();
  }

  std::optional<DisplayEvent> meaningOf(const SDL_Event& event) const {
    switch (event.type) {
      case SDL_KEYDOWN:
        return keyEvent(event.key);
      case SDL_QUIT:
        return DisplayEvent::kClosed;
      case SDL_DISPLAYEVENT:
        if (event.display.event == SDL_DISPLAYEVENT_DISCONNECTED &&
            static_cast<int>(event.display.display) == info_.number) {
          return DisplayEvent::kGone;
        }
        return {};
      case SDL_RENDER_DEVICE_RESET:
        return DisplayEvent::kResized;  // the texture is lost, so the display must be opened again
      case SDL_WINDOWEVENT:
        if (event.window.event == SDL_WINDOWEVENT_CLOSE) return DisplayEvent::kClosed;
        if (event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED &&
            (event.window.data1 != info_.width || event.window.data2 != info_.height)) {
          return DisplayEvent::kResized;
        }
        return {};
      default:
        return {};
    }
  }

  Video video_;
  DisplayInfo info_;
  SDL_Window* window_ = nullptr;
  SDL_Renderer* renderer_ = nullptr;
  SDL_Surface* surface_ = nullptr;  ///< the surface with the last picture
  bool exposed_ = false;
  SDL_Texture* texture_ = nullptr;  ///< null: the window's own surface
  std::vector<std::uint32_t> pixels_;
  void (*finish_)() = nullptr;
};

}  // namespace

std::vector<DisplayInfo> listDisplays() {
  const Video video;
  return displays();
}

std::string describe(const std::vector<DisplayInfo>& displays) {
  std::string text;
  for (const DisplayInfo& info : displays) {
    text += fmt::format("{:>3}  {:<28} {} x {} px  {}  at ({}, {})\n", info.number,
                        '"' + info.name + '"', info.width, info.height,
                        info.refresh_rate > 0 ? fmt::format("{:.0f} Hz", info.refresh_rate)
                                              : "refresh rate unknown",
                        info.x, info.y);
  }
  return text;
}

std::unique_ptr<Display> openSdlDisplay(const std::string& name_or_number) {
  return std::make_unique<SdlDisplay>(name_or_number);
}

}  // namespace lab::projector
