#include "tests/support/tracker_scenes/acceptance_limits.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace lab::cases {
namespace {

constexpr double kSignificance = 0.01;   // for a tracker exactly at its limit
constexpr double kDegreesOfFreedom = 3;  // of a pose

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
  return 0.1 + 3 * std::sqrt(2 / (kDegreesOfFreedom * std::max(tally.nees_count, 1)));
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

std::vector<Shortfall> shortOf(const AcceptanceLimits& limits, const Tally& tally) {
  std::vector<Shortfall> out;
  const int missed = tally.robots - tally.found + tally.flipped;
  if (chanceOf(missed, (1 - limits.recall) * tally.robots) < kSignificance) {
    out.push_back(
        {sentence("%d of %d robots missed or with a reversed heading: %.2f %%, wanted %.2f %%",
                  missed, tally.robots, 100.0 - 100.0 * missed / tally.robots, 100 * limits.recall),
         chanceOf(missed, (1 - limits.recall_known) * tally.robots) >= kSignificance});
  }
  if (std::isfinite(limits.wrong) &&
      chanceOf(tally.wrong, limits.wrong * tally.frames) < kSignificance) {
    out.push_back({sentence("%d wrong poses in %d pictures, allowed %.2f per picture", tally.wrong,
                            tally.frames, limits.wrong)});
  }
  if (!(tally.position <= limits.position)) {
    out.push_back(
        {sentence("positions off by %.4f px, allowed %.4f", tally.position, limits.position)});
  }
  if (!(tally.heading <= limits.heading)) {
    out.push_back(
        {sentence("headings off by %.4f degrees, allowed %.4f", tally.heading, limits.heading)});
  }
  if (limits.honest && !(std::abs(tally.nees - 1) <= allowedNees(tally))) {
    out.push_back({sentence("normalised squared error (NEES) %.3f, wanted 1 +- %.3f", tally.nees,
                            allowedNees(tally))});
  }
  return out;
}

}  // namespace lab::cases
