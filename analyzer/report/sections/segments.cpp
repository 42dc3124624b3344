#include "analyzer/report/sections/segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "analyzer/report/html/html_sections.hpp"
#include "analyzer/report/summary/findings.hpp"
#include "analyzer/report/summary/trajectories.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"
#include "common/text/json_number.hpp"

namespace lab::report {
namespace {

using analysis::JoinComparison;
using analysis::JoinLag;
using analysis::PieceEnd;
using Json = nlohmann::ordered_json;

constexpr double kDefect = 4;  // standard errors, as for the curves
constexpr std::size_t kReasons = static_cast<std::size_t>(PieceEnd::kEnd) + 1;

std::string cell(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : std::string();
}

std::array<std::int64_t, kReasons> countsOf(const RunRecord& record) {
  std::array<std::int64_t, kReasons> counts{};
  for (const PieceRecord& one : record.pieces) {
    ++counts.at(static_cast<std::size_t>(one.piece.reason));
  }
  return counts;
}

Json curveJson(const std::vector<JoinLag>& lags, const std::string& si_unit) {
  const DisplayUnit unit = displayUnit(si_unit);
  const auto column = [&lags](double JoinLag::*member, double factor) {
    Json values = Json::array();
    for (const JoinLag& lag : lags) values.push_back(number(lag.*member * factor));
    return values;
  };
  Json json;
  json["lag_s"] = column(&JoinLag::tau, 1);
  json["share_across_joins"] = column(&JoinLag::share, 1);
  json["all_" + unit.key] = column(&JoinLag::whole, unit.factor);
  json["within_pieces_" + unit.key] = column(&JoinLag::within, unit.factor);
  json["difference_" + unit.key] = column(&JoinLag::difference, unit.factor);
  json["standard_error_" + unit.key] = column(&JoinLag::sigma, unit.factor);
  json["selection_" + unit.key] = column(&JoinLag::selection, unit.factor);
  json["z"] = column(&JoinLag::z, 1);
  Json compared = Json::array();
  for (const JoinLag& lag : lags) compared.push_back(lag.compared);
  json["compared"] = std::move(compared);
  return json;
}

}  // namespace

std::string_view pieceEndText(PieceEnd reason) {
  switch (reason) {
    case PieceEnd::kJoined:
      return "reversal, joined";
    case PieceEnd::kNotJoined:
      return "reversal, cut";
    case PieceEnd::kLostReversal:
      return "reversal of unknown times";
    case PieceEnd::kProgramSwitch:
      return "program switch";
    case PieceEnd::kContact:
      return "contact";
    case PieceEnd::kStop:
      return "stop";
    case PieceEnd::kJump:
      return "jump";
    case PieceEnd::kClockSetBack:
      return "clock set back";
    case PieceEnd::kClockStep:
      return "clock step";
    case PieceEnd::kEnd:
      return "end";
  }
  return "";
}

std::string segmentsCsv(const RunRecord& record) {
  std::vector<const PieceRecord*> rows;
  for (const PieceRecord& one : record.pieces) rows.push_back(&one);
  std::stable_sort(rows.begin(), rows.end(),
                   [](const PieceRecord* a, const PieceRecord* b) { return a->robot < b->robot; });
  fmt::memory_buffer out;
  const auto put = std::back_inserter(out);
  fmt::format_to(put,
                 "robot,program,segment,piece,begin_s,end_s,frames,reason,reversal_start_s,"
                 "reversal_end_s,removed_x_cm,removed_y_cm,turned_rad\n");
  for (const PieceRecord* one : rows) {
    const analysis::Piece& piece = one->piece;
    fmt::format_to(put, "{},{},{},{},{},{},{},\"{}\",{},{},{},{},{}\n", one->robot,
                   csvField(record.programNameOf(one->program)), piece.segment, piece.piece,
                   cell(piece.begin, 6), cell(piece.end, 6), piece.frames,
                   pieceEndText(piece.reason), cell(piece.reversal_start, 6),
                   cell(piece.reversal_end, 6), cell(piece.dx / units::kCentimetre, 4),
                   cell(piece.dy / units::kCentimetre, 4), cell(piece.rotation, 6));
  }
  return fmt::to_string(out);
}

Json stitchingJson(const RunRecord& record) {
  const auto counts = countsOf(record);
  Json ends = Json::object();
  for (std::size_t i = 0; i < kReasons; ++i) {
    if (counts.at(i) > 0) ends[std::string(pieceEndText(static_cast<PieceEnd>(i)))] = counts.at(i);
  }
  return {{"joined", record.stitched},
          {"pieces", record.pieces.size()},
          {"pieces_by_end", std::move(ends)},
          {"headings_turned_round", record.headings.flips},
          {"heading_jumps_by_pi", record.headings.jumps},
          {"heads_that_were_tails", record.headings.sense_turns}};
}

Json joinsJson(const analysis::ProgramResult& result) {
  if (!result.joins || result.joins->joins == 0) return nullptr;
  const JoinComparison& joins = *result.joins;
  const bool judged = joins.compared > 0;
  return {{"joins", joins.joins},
          {"mean_piece_s", number(joins.mean_piece)},
          {"longest_compared_lag_s", number(joins.longest_lag)},
          {"verdict", !judged                           ? "undecided"
                      : std::abs(joins.max_z) < kDefect ? "fit"
                                                        : "do not fit"},
          {"max_z", number(joins.max_z)},
          {"max_z_lag_s", judged ? number(joins.max_z_tau) : Json(nullptr)},
          {"max_z_curve", joins.max_z_angular ? "angular_msd" : "msd"},
          {"compared_lags", joins.compared},
          {"msd", curveJson(joins.msd, "m^2")},
          {"angular_msd", curveJson(joins.angular_msd, "rad^2")}};
}

std::string joinsText(const analysis::ProgramResult& result) {
  if (!result.joins || result.joins->joins == 0) return {};
  const JoinComparison& joins = *result.joins;
  const std::string what =
      fmt::format("{}, one per {} on average: ", countText(joins.joins, "join"),
                  durationText(joins.mean_piece));
  if (joins.compared == 0) {
    return what + "too few windows lie across a join for a comparison with windows without one";
  }
  if (std::abs(joins.max_z) < kDefect) {
    return what + fmt::format(
                      "windows across a join agree with windows without a join (lags up to {} s; "
                      "the largest difference is {:.1f} standard errors, after a correction for "
                      "the fact that windows without a join met no wall)",
                      shortText(joins.longest_lag), std::abs(joins.max_z));
  }
  return what + fmt::format(
                    "the joins do not fit: with windows across a join, the {} at {} s differs by "
                    "{:.1f} standard errors, after a correction for the fact that windows without "
                    "a join met no wall; --no-stitch analyzes without joins",
                    joins.max_z_angular ? "angular MSD" : "MSD", shortText(joins.max_z_tau),
                    std::abs(joins.max_z));
}

namespace html {

std::string stitching(const RunRecord& record) {
  if (record.pieces.empty()) return {};
  std::string html = fmt::format(
      "<h2>Cuts and joins of the tracks</h2>\n<p>{} of free motion; segments.csv lists them with "
      "the reason of their end. {}</p>\n",
      countText(static_cast<std::int64_t>(record.pieces.size()), "piece"),
      record.stitched ? "The track is joined at reversals, because the robot then continues its "
                        "program where it was interrupted; <code>lab analyze --no-stitch</code> "
                        "cuts there instead."
                      : "<strong>Joins are off (--no-stitch):</strong> long windows exist only "
                        "where a robot met no wall, so the curves are biased.");
  const auto counts = countsOf(record);
  Table table({"end of the piece", ">count"});
  for (std::size_t i = 0; i < kReasons; ++i) {
    if (counts.at(i) == 0) continue;
    table.row({std::string(pieceEndText(static_cast<PieceEnd>(i))), groupedText(counts.at(i))});
  }
  html += table.text() + "<ul>\n";
  for (const Finding& finding : findingsOf(record)) {
    const std::string joins = joinsText(finding.pool->result);
    if (joins.empty()) continue;
    html += fmt::format("<li>{}: {}.</li>\n", escapeHtml(finding.name), escapeHtml(joins));
  }
  const HeadingRecord& headings = record.headings;
  if (headings.jumps > 0) {
    html += fmt::format(
        "<li>{} of the heading by π were found, which wheels cannot make: the tracker confused "
        "head and tail. {} turned by π.</li>\n",
        countText(headings.jumps, "jump"), countText(headings.flips, "heading"));
  }
  if (headings.sense_turns > 0) {
    html += fmt::format(
        "<li>In {} the motion showed that head and tail were confused: all headings of it were "
        "turned by π.</li>\n",
        countText(headings.sense_turns, "track"));
  }
  return html + "</ul>\n";
}

}  // namespace html
}  // namespace lab::report
