#include "runner/campaign/twins/twin_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "common/text/format.hpp"
#include "common/text/json_number.hpp"
#include "common/text/json_text.hpp"
#include "runner/campaign/campaign_laws.hpp"

namespace lab::runner::campaign {
namespace {

using TwinJson = nlohmann::ordered_json;

constexpr int kTwinFormat = 1;
constexpr double kBandShare = 0.05;  // of the twins on each side of the band

/// A curve of a summary: values by lag, rounded so that lags of different runs meet.
std::map<double, double> curveOf(const std::string& summary, std::size_t program,
                                 const std::string& key) {
  std::map<double, double> curve;
  const auto json = parseJsonText(summary);
  if (!json.is_object() || !json.contains("programs") || program >= json["programs"].size()) {
    return curve;
  }
  const auto& one = json["programs"][program];
  if (!one.contains("pool") || !one["pool"].contains(key)) return curve;
  const auto& columns = one["pool"][key];
  const nlohmann::json* values = nullptr;
  for (const auto& [name, column] : columns.items()) {
    if (name.starts_with("value_")) values = &column;
  }
  if (values == nullptr || !columns.contains("lag_s")) return curve;
  const auto& lags = columns["lag_s"];
  for (std::size_t i = 0; i < lags.size() && i < values->size(); ++i) {
    if (lags[i].is_number() && (*values)[i].is_number()) {
      curve[lags[i].get<double>()] = (*values)[i].get<double>();
    }
  }
  return curve;
}

std::string pText(double p) {
  if (p < 1e-4) return fmt::format("{:.0e}", p);
  return fmt::format("{:.2g}", p);
}

/// "D_r of NAME (rad²/s)", and of a curve "msd at 1 s of NAME (cm²)".
std::string lookText(const std::string& name) {
  if (name.find(" at ") == std::string::npos) return labelOf(name).text();
  const std::size_t dot = name.find('.');
  const std::size_t bracket = name.find(" (");
  return fmt::format("{} of {}{}", name.substr(dot + 1, bracket - dot - 1), name.substr(0, dot),
                     name.substr(bracket));
}

std::string looksTable(const std::vector<const PlacedLook*>& looks) {
  std::string table =
      "<div class=\"scroll\"><table><tr><th>look</th><th class=\"r\">run</th>"
      "<th class=\"r\">twins</th><th class=\"r\">95 % of twins</th><th class=\"r\">below / "
      "above</th><th class=\"r\">z</th><th class=\"r\">p</th><th class=\"r\">p, all "
      "looks</th></tr>\n";
  for (const PlacedLook* look : looks) {
    const LookTexts texts = textsOf(*look);
    table += fmt::format(
        "<tr><td>{}</td><td class=\"r\">{}</td><td class=\"r\">{}</td><td class=\"r\">{}</td><td "
        "class=\"r\">{} / {}</td><td class=\"r\">{}</td><td class=\"r\">{}</td><td "
        "class=\"r{}\">{}</td></tr>\n",
        escapeHtml(texts.name), texts.run, texts.twins, texts.interval, look->below, look->above,
        texts.z, texts.p, look->p_all < kDeviates ? " deviates" : "", texts.p_all);
  }
  return table + "</table></div>\n";
}

std::string explanation() {
  return fmt::format(
      "<p>A look is one number of the run that its twins have too. z is the deviate of a further "
      "draw beside the twins; the last column is the probability that the largest of all looks "
      "deviates as much by chance. Below {} the run deviates.</p>\n",
      kDeviates);
}

}  // namespace

std::string verdictOf(const TwinReport& report) {
  const TwinComparison& comparison = report.comparison;
  if (comparison.looks.empty()) return "nothing was measured that twins could be compared with";
  const PlacedLook& most = comparison.looks[comparison.most];
  const std::string where =
      fmt::format("{}: {} in the run, {} ± {} in the twins", lookText(most.name),
                  valueText(most.run, most.sigma), valueText(most.mean, most.sigma),
                  valueText(most.sigma, most.sigma));
  return fmt::format(
      "{} {} twins: the most unusual of {} looks is {} (p = {} with all looks taken "
      "into account)",
      comparison.p < kDeviates ? "deviates from its" : "agrees with its", comparison.twins,
      comparison.looks.size(), where, pText(comparison.p));
}

report::ScriptedFigure twinCurve(const std::string& run, const std::vector<std::string>& twins,
                                 std::size_t program, const std::string& key) {
  const std::map<double, double> own = curveOf(run, program, key);
  std::map<double, std::vector<double>> others;
  for (const std::string& twin : twins) {
    for (const auto& [lag, value] : curveOf(twin, program, key)) others[lag].push_back(value);
  }
  std::string data = "$c << EOD\n";
  bool any = false;
  for (const auto& [lag, value] : own) {
    const auto found = others.find(lag);
    if (found == others.end() || found->second.size() < twins.size() / 2 + 1) continue;
    std::vector<double> values = found->second;
    std::ranges::sort(values);
    double mean = 0;
    for (const double other : values) mean += other / static_cast<double>(values.size());
    if (!(mean > 0)) continue;
    const auto at = [&](double share) {
      return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
    };
    data += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g}\n", lag, value / mean, at(kBandShare) / mean,
                        at(1 - kBandShare) / mean);
    any = true;
  }
  const std::vector<std::string> names = programsOfSummary(run);
  const std::string name = program < names.size() ? names[program] : "program";
  report::ScriptedFigure figure;
  figure.name = fmt::format("twins_{}_{}", key, sanitizedFileName(name));
  figure.title =
      fmt::format("{} of {}, relative to its twins", key == "msd" ? "MSD" : "Angular MSD", name);
  figure.caption =
      "Points: the run. Band: from the 5th to the 95th percentile of the twins. Both "
      "over the mean of the twins.";
  if (!any) return figure;
  figure.script =
      report::figurePreamble(figure.name, 760, 460) + data +
      "EOD\nset logscale x\nset xlabel 'lag (s)'\nset ylabel " +
      report::quotedForGnuplot(key == "msd" ? "MSD / mean of the twins"
                                            : "angular MSD / mean of the twins") +
      "\nset key top left\nplot $c using 1:3:4 with filledcurves fc rgb '#c5d9ea' title "
      "'twins', 1 with lines lc rgb '#606060' notitle, $c using 1:2 with points pt 7 ps "
      "0.6 lc rgb '#000000' title 'run'\n";
  return figure;
}

std::vector<std::string> programsOfSummary(const std::string& summary_json) {
  std::vector<std::string> names;
  const auto json = parseJsonText(summary_json);
  if (!json.is_object() || !json.contains("programs")) return names;
  for (const auto& program : json["programs"]) names.push_back(program.value("name", "program"));
  return names;
}

LookTexts textsOf(const PlacedLook& look) {
  return {
      lookText(look.name),
      valueText(look.run, look.sigma),
      fmt::format("{} ± {}", valueText(look.mean, look.sigma), valueText(look.sigma, look.sigma)),
      fmt::format("{} to {}", valueText(look.low95, look.sigma),
                  valueText(look.high95, look.sigma)),
      std::isfinite(look.z) ? fmt::format("{:+.1f}", look.z) : "–",
      pText(look.p),
      pText(look.p_all)};
}

std::vector<const PlacedLook*> mostUnusual(const TwinComparison& comparison, std::size_t most) {
  std::vector<const PlacedLook*> sorted;
  for (const PlacedLook& look : comparison.looks) sorted.push_back(&look);
  std::ranges::stable_sort(sorted, [](const PlacedLook* a, const PlacedLook* b) {
    return a->p_all != b->p_all ? a->p_all < b->p_all : a->p < b->p;
  });
  sorted.resize(std::min(most, sorted.size()));
  return sorted;
}

std::string twinCsv(const TwinReport& report) {
  std::string csv =
      "look,run,twins_mean,twins_standard_deviation,low95,high95,twins_below,twins_above,z,p,"
      "p_all_looks\n";
  const auto cell = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string();
  };
  for (const PlacedLook& look : report.comparison.looks) {
    csv += fmt::format("\"{}\",{},{},{},{},{},{},{},{},{},{}\n", look.name, cell(look.run),
                       cell(look.mean), cell(look.sigma), cell(look.low95), cell(look.high95),
                       look.below, look.above, cell(look.z), cell(look.p), cell(look.p_all));
  }
  return csv;
}

std::string withTwinSection(const std::string& report_page, const TwinReport& report) {
  constexpr std::string_view kBegin = "<!-- twins -->";
  constexpr std::string_view kEnd = "<!-- end of twins -->\n";
  constexpr std::string_view kBodyEnd = "</body>";
  constexpr std::size_t kInReport = 10;
  std::string page = report_page;
  const std::size_t begin = page.find(kBegin);
  const std::size_t end = page.find(kEnd);
  if (begin != std::string::npos && end != std::string::npos && begin < end) {
    page.erase(begin, end + kEnd.size() - begin);
  }
  std::string section = fmt::format(
      "{}<h2>Simulated twins</h2>\n<p>The run {}. <a href=\"twins.html\">All {} "
      "looks</a></p>\n",
      kBegin, escapeHtml(verdictOf(report)), report.comparison.looks.size());
  for (const std::string& remark : report.remarks) {
    section += fmt::format("<p class=\"soft\">{}</p>\n", escapeHtml(remark));
  }
  section += looksTable(mostUnusual(report.comparison, kInReport)) + explanation();
  section += kEnd;
  const std::size_t place = page.rfind(kBodyEnd);
  return page.insert(place == std::string::npos ? page.size() : place, section);
}

std::string twinJson(const TwinReport& report) {
  const TwinComparison& comparison = report.comparison;
  TwinJson looks = TwinJson::array();
  for (const PlacedLook& look : comparison.looks) {
    looks.push_back({{"look", look.name},
                     {"run", number(look.run)},
                     {"twins_mean", number(look.mean)},
                     {"twins_standard_deviation", number(look.sigma)},
                     {"low95", number(look.low95)},
                     {"high95", number(look.high95)},
                     {"twins_below", look.below},
                     {"twins_above", look.above},
                     {"z", number(look.z)},
                     {"p", number(look.p)},
                     {"p_all_looks", number(look.p_all)}});
  }
  TwinJson json;
  json["format"] = kTwinFormat;
  json["run"] = report.run;
  json["version"] = report.version;
  json["twins"] = comparison.twins;
  json["agrees"] = comparison.p >= kDeviates;
  json["p_all_looks"] = number(comparison.p);
  json["looks"] = std::move(looks);
  json["not_measured"] = comparison.absent;
  json["remarks"] = report.remarks;
  return json.dump(1, ' ', false, TwinJson::error_handler_t::replace) + "\n";
}

std::string twinHtml(const TwinReport& report, const std::vector<report::DrawnFigure>& figures) {
  const TwinComparison& comparison = report.comparison;
  const bool agrees = comparison.p >= kDeviates;
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0} and its twins</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0} and its "
      "twins</h1>\n<p class=\"lead\">{2} simulations of the same experiment, with the frames, "
      "losses, "
      "noise and light of the run · version {3}</p>\n<p class=\"verdict {4}\">The run {5}.</p>\n",
      escapeHtml(report.run), report::pageStyle(), comparison.twins, escapeHtml(report.version),
      agrees ? "agrees" : "deviates", escapeHtml(verdictOf(report)));
  for (const std::string& remark : report.remarks) {
    page += fmt::format("<p class=\"soft\">{}</p>\n", escapeHtml(remark));
  }
  page += "<div class=\"figures\">\n";
  for (const report::DrawnFigure& figure : figures) {
    page += fmt::format("<figure>{}<figcaption><b>{}.</b> {}</figcaption></figure>\n",
                        report::svgElement(figure.svg, figure.name + "_"), escapeHtml(figure.title),
                        escapeHtml(figure.caption));
  }
  page += "</div>\n<h2>Looks</h2>\n" + looksTable(mostUnusual(comparison, comparison.looks.size()));
  page += explanation();
  return page + "</body>\n</html>\n";
}

}  // namespace lab::runner::campaign
