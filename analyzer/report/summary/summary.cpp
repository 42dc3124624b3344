#include "analyzer/report/summary/summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "analyzer/report/record/step_delays.hpp"
#include "analyzer/report/sections/crowd_section.hpp"
#include "analyzer/report/sections/fit_section.hpp"
#include "analyzer/report/sections/kurtosis_section.hpp"
#include "analyzer/report/sections/light_bands.hpp"
#include "analyzer/report/sections/run_section.hpp"
#include "analyzer/report/sections/segments.hpp"
#include "analyzer/report/summary/findings.hpp"
#include "common/process/version.hpp"
#include "common/text/format.hpp"
#include "common/text/json_number.hpp"

namespace lab::report {
namespace {

using Json = nlohmann::ordered_json;
using analysis::CurvePoint;

constexpr int kFormat = 1;  // of summary.json

Json secondsOrNull(const RunRecord& record, std::int64_t utime) {
  return utime == 0 ? Json(nullptr) : number(record.seconds(utime));
}

/// One array per column. The curve of a single robot omits the columns that equal those of the
/// pool.
Json curve(const std::vector<CurvePoint>& points, const std::string& si_unit, bool whole) {
  const DisplayUnit unit = displayUnit(si_unit);
  const auto column = [&points](auto value) {
    Json values = Json::array();
    for (const CurvePoint& point : points) {
      if (point.windows > 0) values.push_back(value(point));
    }
    return values;
  };
  const auto in_unit = [&](double CurvePoint::*member) {
    return column([&](const CurvePoint& point) { return number(point.*member * unit.factor); });
  };
  const auto plain = [&](double CurvePoint::*member) {
    return column([&](const CurvePoint& point) { return number(point.*member); });
  };
  Json json;
  json["lag_s"] = plain(&CurvePoint::tau);
  json["value_" + unit.key] = in_unit(&CurvePoint::value);
  json["standard_error_" + unit.key] = in_unit(&CurvePoint::sigma);
  json["windows"] = plain(&CurvePoint::windows);
  if (!whole) return json;
  json["noise_" + unit.key] = in_unit(&CurvePoint::noise);
  json["exact_" + unit.key] = in_unit(&CurvePoint::exact);
  json["paper_" + unit.key] = in_unit(&CurvePoint::paper);
  json["z"] = plain(&CurvePoint::z);
  json["effective_windows"] = plain(&CurvePoint::n_eff);
  json["kurtosis"] = plain(&CurvePoint::kurtosis);
  json["selection_biased"] = column([](const CurvePoint& point) { return point.selection_biased; });
  json["judged"] = column([](const CurvePoint& point) { return point.judged; });
  return json;
}

Json wholeMotion(const analysis::WholeMotion& whole) {
  const auto column = [&whole](double analysis::WholeLag::*member, const std::string& si_unit) {
    Json values = Json::array();
    const double factor = displayUnit(si_unit).factor;
    for (const analysis::WholeLag& lag : whole.lags) values.push_back(number(lag.*member * factor));
    return values;
  };
  return {{"observed_s", number(whole.observed)},
          {"speed_cm_s", number(whole.speed * displayUnit("m/s").factor)},
          {"lag_s", column(&analysis::WholeLag::tau, "s")},
          {"msd_cm2", column(&analysis::WholeLag::msd, "m^2")},
          {"angular_msd_rad2", column(&analysis::WholeLag::angular_msd, "rad^2")},
          {"windows", column(&analysis::WholeLag::windows, "")}};
}

Json result(const analysis::ProgramResult& result, bool whole) {
  constexpr std::array kVerdicts{"undecided", "agrees", "disagrees"};
  const bool judged = result.law.known() && result.no_verdict.empty();
  Json json;
  json["robots"] = result.robots;
  json["restriction"] = restriction(result).empty() ? Json(nullptr) : Json(restriction(result));
  json["restricted"] = isRestricted(result);
  json["time_shares"] = {{"free", number(result.shares.free)},
                         {"contact", number(result.shares.contact)},
                         {"reversing", number(result.shares.reversing)},
                         {"stopped", number(result.shares.stopped)},
                         {"lost", number(result.shares.lost)}};
  if (result.whole) json["whole_motion"] = wholeMotion(*result.whole);
  json["verdict"] = judged ? kVerdicts.at(static_cast<std::size_t>(result.verdict.kind)) : "no law";
  json["max_z"] = number(result.verdict.max_z);
  json["max_z_lag_s"] = number(result.verdict.tau);
  json["max_z_curve"] = result.verdict.draws     ? "draws"
                        : result.verdict.turning ? "turning"
                        : result.verdict.hold    ? "hold"
                        : result.verdict.angular ? "angular_msd"
                                                 : "msd";
  json["judged_lags"] = result.verdict.judged;
  json["misfit"] = result.verdict.misfit;
  json["rejected"] = result.verdict.rejected;
  if (result.law->isSimulated()) json["reference"] = "simulated";
  if (!result.no_verdict.empty()) json["no_verdict"] = result.no_verdict;
  json["observed_s"] = number(result.observed);
  json["samples"] = result.samples;
  json["lost_frames"] = result.lost;
  json["segments"] = result.segments;
  json["reversals"] = result.reversals;
  json["contact_share"] = number(result.contact_share);
  json["longest_unselected_lag_s"] = result.unbiased_lag > 0 ? number(result.unbiased_lag) : Json();
  json["estimates"] = estimatesJson(result.estimates);
  if (result.fit) json["fit"] = fitJson(*result.fit);
  if (result.runs) json["runs"] = runsJson(*result.runs, whole);
  if (whole) json["joins"] = joinsJson(result);
  if (result.kurtosis) json["kurtosis"] = kurtosisJson(*result.kurtosis);
  json["msd"] = curve(result.curves.msd, "m^2", whole);
  json["angular_msd"] = curve(result.curves.angular_msd, "rad^2", whole);
  return json;
}

/// The parameters of a program under the keys of experiment files, as in "v_cm_s".
Json parameterValues(const analysis::FeedResult& result) {
  Json values = Json::object();
  for (const ProgramParameter& parameter : result.definition.parameters) {
    const DisplayUnit unit = displayUnit(parameter.unit);
    const std::string key = unit.key.empty() ? parameter.name : parameter.name + "_" + unit.key;
    values[key] = number(parameter.value * unit.factor);
  }
  return values;
}

Json programs(const RunRecord& record) {
  Json all = Json::array();
  for (const Finding& finding : findingsOf(record)) {
    Json json;
    json["name"] = finding.name;
    json["model"] = finding.model;
    json["parameters"] = parametersText(*finding.pool);
    json["parameter_values"] = parameterValues(*finding.pool);
    json["pool"] = result(finding.pool->result, true);
    Json robots = Json::array();
    for (const analysis::FeedResult* robot : finding.robots) {
      Json one = {{"robot", robot->result.robot}};
      one.update(result(robot->result, false));
      robots.push_back(std::move(one));
    }
    json["each_robot"] = std::move(robots);
    all.push_back(std::move(json));
  }
  return all;
}

Json serialLines(const RunRecord& record) {
  Json all = Json::array();
  for (const SerialLine& line : record.serial_lines) {
    all.push_back({{"line", line.text},
                   {"received", line.received},
                   {"lost", line.lost},
                   {"decode_errors", line.decode_errors}});
  }
  return all;
}

Json losses(const RunRecord& record) {
  Json streams = Json::array();
  for (const StreamLoss& stream : record.log.streams) {
    streams.push_back({{"channel", stream.channel},
                       {"sender", stream.sender},
                       {"start", stream.start},
                       {"received", stream.received},
                       {"lost", stream.lost},
                       {"lost_is_at_least", stream.at_least},
                       {"largest_age_ms", number(stream.largest_age * 1e3)}});
  }
  Json listeners = Json::array();
  for (const ListenerLoss& loss : record.listeners) {
    listeners.push_back({{"listener", loss.listener},
                         {"channel", loss.channel},
                         {"sender", loss.sender},
                         {"lost", loss.lost},
                         {"decode_errors", loss.decode_errors}});
  }
  Json json;
  json["log"] = std::move(streams);
  json["listeners"] = std::move(listeners);
  json["decode_errors"] =
      record.log.decode_errors.empty() ? Json::object() : Json(record.log.decode_errors);
  json["damaged_places_in_log"] = record.log.damaged_places;
  for (const auto& [channel, refused] : record.log.refused) {
    json["refused"][channel] = {{"messages", refused.count}, {"first", refused.first}};
    if (refused.robots > 0) json["refused"][channel]["robots"] = refused.robots;
  }
  if (record.log.bad_times > 0) json["damaged_times_in_log"] = record.log.bad_times;
  json["camera_frames"] = record.log.frames;
  json["camera_frames_missing"] = record.missing_frames;
  return json;
}

Json links(const RunRecord& record) {
  Json all = Json::array();
  for (const LinkRecord& link : record.links) {
    all.push_back({{"host", link.host},
                   {"other_host", link.peer},
                   {"received", link.received},
                   {"lost", link.lost},
                   {"repeated", link.repeated},
                   {"stale", link.stale},
                   {"clashing", link.clashing},
                   {"timeouts", link.timeouts},
                   {"interruptions", link.interruptions},
                   {"lowest_clock_offset_ms", number(link.lowest_offset * 1e3)},
                   {"highest_clock_offset_ms", number(link.highest_offset * 1e3)},
                   {"round_trip_ms", number(link.round_trip * 1e3)},
                   {"trouble", link.trouble}});
  }
  return all;
}

Json steps(const RunRecord& record) {
  Json all = Json::array();
  for (const StepRecord& step : record.steps) {
    const StepDelays delays = delaysOf(step);
    all.push_back({{"step", step.number},
                   {"label", step.label},
                   {"commanded_s", secondsOrNull(record, step.commanded_utime)},
                   {"presented_s", secondsOrNull(record, step.presented_utime)},
                   {"seen_s", secondsOrNull(record, step.seen_utime)},
                   {"first_acted_s", secondsOrNull(record, step.first_acted_utime)},
                   {"last_acted_s", secondsOrNull(record, step.last_acted_utime)},
                   {"robots_acted", step.robots_acted},
                   {"robots_expected", step.robots_expected},
                   {"presented_after_ms", number(delays.presented_ms)},
                   {"seen_after_ms", number(delays.seen_ms)},
                   {"ended_by", step.ended_by},
                   {"last_acted_after_ms", number(delays.last_acted_ms)}});
  }
  return all;
}

Json latency(const Percentiles& percentiles, const char* count = "steps") {
  return {{count, percentiles.count},
          {"p50_ms", number(percentiles.p50)},
          {"p95_ms", number(percentiles.p95)},
          {"p99_ms", number(percentiles.p99)},
          {"max_ms", number(percentiles.max)}};
}

Json remarks(const RunRecord& record, const std::vector<Remark>& list) {
  Json all = Json::array();
  for (const Remark& remark : list) {
    all.push_back({{"t_s", secondsOrNull(record, remark.utime)}, {"text", remark.text}});
  }
  return all;
}

Json robots(const RunRecord& record) {
  Json all = Json::array();
  for (const auto& [id, robot] : record.robots) {
    const double states = static_cast<double>(std::max<std::int64_t>(1, robot.states));
    const auto share = [states](std::int64_t count) {
      return number(static_cast<double>(count) / states);
    };
    all.push_back({{"robot", id},
                   {"origin", originName(robot.origin)},
                   {"boots", robot.boots},
                   {"reversals", robot.reversals},
                   {"tumbles", robot.tumbles},
                   {"limited_share", share(robot.limited)},
                   {"limited_reports", robot.limited},
                   {"contact_robot_share", share(robot.contact_robot)},
                   {"contact_wall_share", share(robot.contact_wall)},
                   {"stopped_share", share(robot.stopped)},
                   {"lease_expired_share", share(robot.lease_expired)}});
  }
  return all;
}

}  // namespace

std::string summaryJson(const RunRecord& record) {
  Json json;
  json["format"] = kFormat;
  json["experiment"] = record.experiment ? Json(record.experiment->name) : Json(nullptr);
  json["seed"] = record.experiment ? Json(record.experiment->seed) : Json(nullptr);
  json["run_with_version"] = record.version;
  json["analyzed_with_version"] = kVersion;
  json["contract_version"] = record.contract_version;
  if (record.poses) {
    json["poses"] = {{"rows", record.poses->rows},
                     {"rows_without_pose", record.poses->without_pose},
                     {"rows_without_track", record.poses->without_id},
                     {"rows_repeated", record.poses->repeated},
                     {"poses_contradicted", record.poses->contradicted},
                     {"frames_with_bad_times", record.poses->bad_times},
                     {"clock_steps", record.poses->clock_steps},
                     {"reversals_found", record.poses->reversals},
                     {"headings", record.poses->headings},
                     {"doubts", record.poses->doubts}};
  }
  json["duration_s"] = number(record.duration());
  json["ended"] = record.ended;
  json["end_reason"] = record.end_reason;
  json["faults"] = remarks(record, record.faults);
  json["marks"] = remarks(record, record.marks);
  json["programs"] = programs(record);
  if (!record.crowds.empty()) json["collective"] = crowdsJson(record);
  json["stitching"] = stitchingJson(record);
  json["robots"] = robots(record);
  json["latency"] = {{"presented", latency(presentedDelays(record.steps))},
                     {"seen", latency(seenDelays(record.steps))},
                     {"first_acted", latency(firstActedDelays(record.steps))},
                     {"last_acted", latency(lastActedDelays(record.steps))}};
  json["steps"] = steps(record);
  if (const Percentiles delays = senseDelays(record); delays.count > 0) {
    json["virtual_senses"] = latency(delays, "values");
  }
  for (const SenseRecord& sense : record.senses) {
    json["sense_values"].push_back({{"sense", sense.index},
                                    {"what", sense.what},
                                    {"values", sense.values},
                                    {"mean", number(sense.mean)},
                                    {"scatter", number(sense.deviation)},
                                    {"lowest", number(sense.lowest)},
                                    {"highest", number(sense.highest)}});
  }
  json["light_bands"] = lightBandsJson(record);
  json["losses"] = losses(record);
  if (!record.film_note.empty()) json["retracked"] = record.film_note;
  for (const FilmFacts& film : record.films) {
    json["films"].push_back({{"codec", film.codec},
                             {"frames", film.frames},
                             {"lost", film.lost},
                             {"after_end", film.after_end},
                             {"bytes", film.bytes},
                             {"cpu_s", number(film.cpu)},
                             {"problem", film.problem}});
    if (!film.camera.empty()) json["films"].back()["camera"] = film.camera;
  }
  if (!record.serial_lines.empty()) json["serial_lines"] = serialLines(record);
  if (!record.links.empty()) json["links"] = links(record);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace lab::report
