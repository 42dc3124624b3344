#include "analyzer/report/sections/kurtosis_section.hpp"

#include <nlohmann/json.hpp>

#include "common/text/format.hpp"
#include "common/text/json_number.hpp"

namespace lab::report {
namespace {

using analysis::KurtosisPoint;
using Json = nlohmann::ordered_json;

Json answer(const analysis::KurtosisAnswer& answer) {
  return {{"p", number(answer.p)}, {"lag_s", number(answer.tau)}, {"rejected", answer.rejected}};
}

}  // namespace

Json kurtosisJson(const analysis::KurtosisTest& test) {
  const auto column = [&test](double KurtosisPoint::*member) {
    Json values = Json::array();
    for (const KurtosisPoint& lag : test.lags) values.push_back(number(lag.*member));
    return values;
  };
  return {{"text", test.text},
          {"in_the_plane", answer(test.isotropic)},
          {"as_programmed", answer(test.exact)},
          {"lag_s", column(&KurtosisPoint::tau)},
          {"kurtosis", column(&KurtosisPoint::kurtosis)},
          {"standard_error", column(&KurtosisPoint::sigma)},
          {"programmed", column(&KurtosisPoint::exact)},
          {"z_in_the_plane", column(&KurtosisPoint::z_isotropic)},
          {"z_as_programmed", column(&KurtosisPoint::z_exact)}};
}

std::string kurtosisHtml(const analysis::KurtosisTest& test) {
  return "<p><b>Is this Brownian motion?</b> " + escapeHtml(test.text) + "</p>\n";
}

}  // namespace lab::report
