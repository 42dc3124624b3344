// All exact tables: in free space, in the arena, and with real hardware in the arena. If only the
// arena fails, the error is in the stitching of reversals.
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "tests/system/laws/hour_ensemble.hpp"

namespace lab::system_test::ensemble_long_test {
namespace {

struct Place {
  const char* name;
  Room room;
  Hardware hardware;
};

class AllSimulatedHours : public testing::TestWithParam<std::tuple<Place, const char*>> {};

TEST_P(AllSimulatedHours, FollowTheExactLaw) {
  const auto& [place, table] = GetParam();
  const HourRecordings recordings = {
      .table = table, .room = place.room, .hardware = place.hardware};
  expectExactLaw(recordings, recordHours(recordings));
}

INSTANTIATE_TEST_SUITE_P(
    Tables, AllSimulatedHours,
    testing::Combine(testing::Values(Place{"FreeSpace", Room::kFreeSpace, Hardware::kIdeal},
                                     Place{"Arena", Room::kArena, Hardware::kIdeal},
                                     Place{"RealHardware", Room::kArena, Hardware::kReal}),
                     testing::Values("fig2b_ABP_v3_eps0.5_eta3", "fig2c_ABP_v3_eps0.1_eta3",
                                     "fig2c_ABP_v3_eps0.25_eta3", "fig2c_ABP_v3_eps0.5_eta3",
                                     "fig2c_ABP_v3_eps0.9_eta3", "fig2d_ABP_v3_eps0.25_eta1",
                                     "fig2d_ABP_v3_eps0.25_eta3", "fig2d_ABP_v3_eps0.25_eta4",
                                     "fig2d_ABP_v3_eps0.25_eta6", "fig3b_NABP_va1_V10_eps0.1",
                                     "fig3d_BP_V3_eps0.2", "fig3d_BP_V7_eps0.2",
                                     "fig3d_BP_V10_eps0.2", "fig3dinset_BP_V7_eps0.4",
                                     "fig3dinset_BP_V10_eps0.1", "fig3dinset_BP_V10_eps0.4",
                                     "fig4d_RTP_v5_gam1_tt0.5", "fig4d_RTP_v5_gam3_tt0.5",
                                     "fig4e_RTP_v5_gam1_tt1")),
    [](const auto& parameter) {
      return std::string(std::get<0>(parameter.param).name) + "_" +
             testName(std::get<1>(parameter.param));
    });

}  // namespace
}  // namespace lab::system_test::ensemble_long_test
