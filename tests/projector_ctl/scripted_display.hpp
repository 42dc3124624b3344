/// A display that is controlled by a test.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "projector_ctl/display/display.hpp"

namespace lab::projector {

/// Controls and observes the displays of a test. Must outlive them.
struct DisplayScript {
  DisplayInfo info{0, "bench", 0, 0, 240, 180, 60};
  bool there = true;                   ///< false: it cannot be opened
  bool waits = false;                  ///< result of mayWait()
  bool breaks = false;                 ///< the next present() fails
  std::vector<DisplayEvent> events{};  ///< returned by the next events()
  std::function<void()> swap{};        ///< called by each present()
  int opened = 0;
  int closed = 0;
  int presented = 0;
  optics::GreyImage screen{};  ///< the picture on the display
};

class ScriptedDisplay final : public Display {
 public:
  explicit ScriptedDisplay(DisplayScript& script) : script_(script), info_(script.info) {
    if (!script.there) throw DisplayError("display \"" + info_.name + "\": not there");
    ++script_.opened;
    script_.screen = optics::GreyImage(info_.width, info_.height, 1);
  }
  ScriptedDisplay(const ScriptedDisplay&) = delete;
  ScriptedDisplay& operator=(const ScriptedDisplay&) = delete;
  ~ScriptedDisplay() override { ++script_.closed; }

  [[nodiscard]] const DisplayInfo& info() const override { return info_; }
  [[nodiscard]] bool mayWait() const override { return script_.waits; }

  void present(const optics::GreyView& picture, std::span<const Box> changed) override {
    if (std::exchange(script_.breaks, false)) throw DisplayError("display: lost");
    for (const Box& box : changed) {
      for (int y = box.y; y < box.y + box.height; ++y) {
        for (int x = box.x; x < box.x + box.width; ++x) {
          script_.screen.row(y)[x] = picture.row(y)[x];
        }
      }
    }
    ++script_.presented;
    if (script_.swap) script_.swap();
  }

  [[nodiscard]] std::vector<DisplayEvent> events() override {
    return std::exchange(script_.events, {});
  }

 private:
  DisplayScript& script_;
  DisplayInfo info_;
};

}  // namespace lab::projector
