#include "runner/film/film_overlay.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "light/optics/simulated_camera.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner {
namespace {

/// The number of frames; a contact sheet has twelve tiles, so longer films are thinned.
class ContactSheet : public testing::TestWithParam<int> {};

TEST_P(ContactSheet, IsWrittenForAFilmOfAnyLength) {
  const TemporaryFolder folder;
  OverlaySettings settings;
  settings.path = folder / "sheet.png";
  settings.camera = optics::CameraModel(optics::simulatedCamera(320, 240, 1.2, 0.9));
  const auto sheet = FilmOverlay::open(settings);
  for (int i = 0; i < GetParam(); ++i) {
    const optics::GreyImage image(320, 240, static_cast<std::uint8_t>(i));
    OverlayFrame frame{};
    frame.picture = image.view();
    sheet->add(frame);
  }
  sheet->finish();
  EXPECT_GT(std::filesystem::file_size(settings.path), 1000U);
}

INSTANTIATE_TEST_SUITE_P(Films, ContactSheet, testing::Values(1, 12, 13, 24, 25, 50));

}  // namespace
}  // namespace lab::runner
