#include "tests/support/tracker_scenes/acceptance_limits.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace lab::cases {
namespace {

constexpr double kRarely = 0.01;  // of the runs of a tracker that is exactly as good as its bar
constexpr double kFreedoms = 3;   // of a pose

__attribute__((format(printf, 1, 2))) std::string sentence(const char* format, ...) {
  char text[160];
  va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  return text;
}

}  // namespace

double allowedNees(const Tally& tally) {
  return 0.1 + 3 * std::sqrt(2 / (kFreedoms * std::max(tally.surprises, 1)));
}

double chanceOf(int count, double expected) {
  double fewer = 0;
  double term = std::exp(-expected);
  for (int i = 0; i < count; ++i) {
    fewer += term;
    term *= expected / (i + 1);
  }
  return std::max(0.0, 1 - fewer);
}

std::vector<Shortfall> shortOf(const AcceptanceLimits& bars, const Tally& tally) {
  std::vector<Shortfall> out;
  const int missed = tally.robots - tally.found + tally.flipped;
  if (chanceOf(missed, (1 - bars.recall) * tally.robots) < kRarely) {
    out.push_back(
        {sentence("%d of %d robots missed or turned round: %.2f %%, wanted %.2f %%", missed,
                  tally.robots, 100.0 - 100.0 * missed / tally.robots, 100 * bars.recall),
         chanceOf(missed, (1 - bars.recall_known) * tally.robots) >= kRarely});
  }
  if (std::isfinite(bars.wrong) && chanceOf(tally.wrong, bars.wrong * tally.frames) < kRarely) {
    out.push_back({sentence("%d wrong poses in %d pictures, allowed %.2f a picture", tally.wrong,
                            tally.frames, bars.wrong)});
  }
  if (!(tally.position <= bars.position)) {
    out.push_back(
        {sentence("positions off by %.4f px, allowed %.4f", tally.position, bars.position)});
  }
  if (!(tally.heading <= bars.heading)) {
    out.push_back(
        {sentence("headings off by %.4f degrees, allowed %.4f", tally.heading, bars.heading)});
  }
  if (bars.honest && !(std::abs(tally.surprise - 1) <= allowedNees(tally))) {
    out.push_back({sentence("errors squared %.3f times what is claimed, wanted 1 +- %.3f",
                            tally.surprise, allowedNees(tally))});
  }
  return out;
}

}  // namespace lab::cases
