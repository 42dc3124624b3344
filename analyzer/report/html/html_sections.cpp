#include "analyzer/report/html/html_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>

#include "analyzer/report/figures/gnuplot.hpp"
#include "analyzer/report/record/step_delays.hpp"
#include "common/math/units.hpp"
#include "common/process/installation.hpp"
#include "common/process/version.hpp"
#include "common/text/format.hpp"

namespace lab::report::html {
namespace {

using units::kPercents;

constexpr std::size_t kMostSteps = 60;  // largest number of rows in the table of steps

std::string milliseconds(double value) {
  return std::isfinite(value) ? fmt::format("{:.1f}", value) : "–";
}

std::string share(std::int64_t count, std::int64_t of) {
  if (count == 0 || of == 0) return "0";
  return fmt::format("{:.2g} %", kPercents * static_cast<double>(count) / static_cast<double>(of));
}

std::string remarkList(const RunRecord& record, const std::vector<Remark>& remarks,
                       const char* what) {
  std::string html;
  for (const Remark& remark : remarks) {
    html += fmt::format("<p><b>{} at {}:</b> {}</p>\n", what,
                        durationText(record.seconds(remark.utime)), escapeHtml(remark.text));
  }
  return html;
}

std::string sentence(std::string text) {
  text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text;
}

void latencyRow(Table& table, const char* name, const Percentiles& percentiles) {
  table.row({name, std::to_string(percentiles.count), milliseconds(percentiles.p50),
             milliseconds(percentiles.p95), milliseconds(percentiles.p99),
             milliseconds(percentiles.max)});
}

/// A figure with its caption, or the sentence in its place.
std::string figureHtml(const Figure& figure) {
  if (figure.svg.empty()) {
    return fmt::format("<p class=\"soft\">{}</p>\n", escapeHtml(figure.sentence));
  }
  // Ids within the page must be unique, as the names of figures are.
  return fmt::format("<figure>{}<figcaption><b>{}.</b> {}</figcaption></figure>\n",
                     inlineSvg(figure.svg, figure.name + "_"), escapeHtml(figure.title),
                     escapeHtml(figure.caption));
}

}  // namespace

Table::Table(const std::vector<std::string>& columns) {
  text_ = "<div class=\"scroll\"><table><thead><tr>";
  for (const std::string& column : columns) {
    const bool right = !column.empty() && column.front() == '>';
    right_.push_back(right);
    text_ +=
        fmt::format("<th{}>{}</th>", right ? " class=\"r\"" : "", column.substr(right ? 1 : 0));
  }
  text_ += "</tr></thead><tbody>\n";
}

void Table::row(const std::vector<std::string>& cells) {
  text_ += "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    text_ += fmt::format("<td{}>{}</td>", right_[i] ? " class=\"r\"" : "", cells[i]);
  }
  text_ += "</tr>\n";
}

std::string warnings(const RunRecord& record) {
  std::string html = remarkList(record, record.faults, "Fault");
  if (!record.ended) {
    html +=
        "<p><b>This run was cut short:</b> the log has no END event. The report covers the part in "
        "the log.</p>\n";
  }
  // Ended by a command, not by its script or duration.
  if (record.ended && record.end_reason.starts_with("ended by ")) {
    html += fmt::format("<p><b>This run was cut short:</b> {}, after {} s of {} s.</p>\n",
                        escapeHtml(record.end_reason), shortText(record.duration()),
                        shortText(record.experimentOrDefault().duration));
  }
  if (record.log.frames == 0) {
    html += "<p><b>No camera frame is in the log:</b> there is no motion to analyze.</p>\n";
  }
  if (record.poses) {
    for (const std::string& doubt : record.poses->doubts) {
      html += fmt::format("<p><b>Units:</b> {}.</p>\n", escapeHtml(doubt));
    }
  }
  if (record.log.damaged_places > 0) {
    html += fmt::format(
        "<p><b>The log is damaged</b> in {}; the report covers the readable part.</p>\n",
        countText(record.log.damaged_places, "place"));
  }
  for (const std::string& line : refusalTexts(record)) {
    html += fmt::format("<p><b>Refused:</b> {}.</p>\n", escapeHtml(line));
  }
  if (totalOf(record.log.streams).lost > 0) {
    html += fmt::format("<p><b>Lost:</b> {}.</p>\n", lossText(record));
  }
  if (!record.experiment_problem.empty()) {
    html += fmt::format("<p><b>Experiment:</b> {}.</p>\n", escapeHtml(record.experiment_problem));
  }
  html += remarkList(record, record.marks, "Mark");
  return html.empty() ? html : "<div class=\"warn\">\n" + html + "</div>\n";
}

std::string openingFigures(const std::vector<Figure>& figures,
                           const std::vector<std::string>& names) {
  std::string html;
  std::string sentences;
  for (const std::string& name : names) {
    const auto found = std::find_if(figures.begin(), figures.end(),
                                    [&](const Figure& figure) { return figure.name == name; });
    if (found == figures.end()) continue;
    (found->svg.empty() ? sentences : html) += figureHtml(*found);
  }
  return (html.empty() ? html : "<div class=\"opening\">\n" + html + "</div>\n") + sentences;
}

std::string figureGrid(const std::vector<Figure>& figures, const std::vector<std::string>& names) {
  std::string html;
  for (const Figure& figure : figures) {
    if (std::find(names.begin(), names.end(), figure.name) != names.end()) {
      html += figureHtml(figure);
    }
  }
  return html.empty() ? html : "<div class=\"figures\">\n" + html + "</div>\n";
}

std::string otherFigures(const std::vector<Figure>& figures,
                         const std::vector<std::string>& opening) {
  std::string html;
  std::string sentences;
  for (const Figure& figure : figures) {
    if (std::find(opening.begin(), opening.end(), figure.name) != opening.end()) continue;
    (figure.svg.empty() ? sentences : html) += figureHtml(figure);
  }
  if (html.empty() && sentences.empty()) return {};
  return "<h2>More figures</h2>\n<p>In the curves, points are measured and bars are one standard "
         "error. The solid line is what the motion is compared with, with the tracker’s noise: "
         "the exact law of the program, its own formulas, or simulated recordings of it. The "
         "dashed line, where there is one, is the paper’s formula. Below each curve are the "
         "deviations from the solid line in standard errors; from 4 on, a point deviates. "
         "Neighbouring lags share their data "
         "and are correlated. Hollow points are not judged: they have too few independent windows, "
         "or their windows are a biased sample because the light depends on the "
         "position.</p>\n<div class=\"figures\">\n" +
         html + "</div>\n" + sentences;
}

std::string lightSteps(const RunRecord& record) {
  if (record.steps.empty()) return {};
  std::string html =
      "<h2>Light switching</h2>\n<p>Delays from the command of a step to its first frame on the "
      "arena, to the first camera picture that shows it, and to the first and the last robot that "
      "changed its program.</p>\n";
  Table latency({"", ">steps", ">median (ms)", ">95 % (ms)", ">99 % (ms)", ">longest (ms)"});
  latencyRow(latency, "presented", presentedDelays(record.steps));
  const Percentiles seen = seenDelays(record.steps);
  if (seen.count > 0) latencyRow(latency, "seen by the camera", seen);
  latencyRow(latency, "first robot acted", firstActedDelays(record.steps));
  latencyRow(latency, "last robot acted", lastActedDelays(record.steps));
  html += latency.text();
  Table table({">step", "label", ">commanded at (s)", ">presented after (ms)", ">seen after (ms)",
               ">first robot after (ms)", ">last robot after (ms)", ">robots acted",
               "previous step ended by"});
  for (std::size_t i = 0; i < std::min(kMostSteps, record.steps.size()); ++i) {
    const StepRecord& step = record.steps[i];
    const StepDelays delays = delaysOf(step);
    table.row({std::to_string(step.number), escapeHtml(step.label),
               fmt::format("{:.3f}", record.seconds(step.commanded_utime)),
               milliseconds(delays.presented_ms), milliseconds(delays.seen_ms),
               milliseconds(delays.first_acted_ms), milliseconds(delays.last_acted_ms),
               fmt::format("{} of {}", step.robots_acted, step.robots_expected),
               escapeHtml(step.ended_by)});
  }
  html += "<details><summary>Step by step</summary>\n" + table.text();
  if (record.steps.size() > kMostSteps) {
    html +=
        fmt::format("<p class=\"soft\">The first {} of {} steps; all are in summary.json.</p>\n",
                    kMostSteps, record.steps.size());
  }
  return html + "</details>\n";
}

std::string virtualSenses(const RunRecord& record) {
  const Percentiles delays = senseDelays(record);
  if (delays.count == 0 && record.senses.empty()) return {};
  std::string html = "<h2>Virtual senses</h2>\n";
  if (!record.senses.empty()) {
    Table values({"", "", ">values", ">mean", ">scatter", ">lowest", ">highest"});
    for (const SenseRecord& sense : record.senses) {
      values.row({fmt::format("sense({})", sense.index), escapeHtml(sense.what),
                  std::to_string(sense.values), shortText(sense.mean), shortText(sense.deviation),
                  shortText(sense.lowest), shortText(sense.highest)});
    }
    html +=
        "<p>What programs read, over all robots and times; the scatter is the standard "
        "deviation. The mean of an angle is that of the numbers from -π to π.</p>\n" +
        values.text();
  }
  if (delays.count == 0) return html;
  const Senses& senses = record.experimentOrDefault().senses;
  Table table({"", ">values", ">median (ms)", ">95 % (ms)", ">99 % (ms)", ">longest (ms)"});
  latencyRow(table, "exposure to robot", delays);
  return html +
         fmt::format(
             "<p>Delays of the numbers that the host computed from the "
             "tracker's poses, from the exposure of the camera frame to their reception by a "
             "robot. "
             "The experiment asks for {} ms.</p>\n",
             shortText(senses.delay * 1e3)) +
         table.text();
}

std::string robots(const RunRecord& record) {
  if (record.robots.empty()) return {};
  Table table({">robot", "origin", ">reversals", ">tumbles", ">contact with a robot",
               ">contact with a wall", ">limited", ">reports with limits", ">stopped",
               ">without host", ">boots"});
  for (const auto& [id, robot] : record.robots) {
    table.row({std::to_string(id), originName(robot.origin), std::to_string(robot.reversals),
               std::to_string(robot.tumbles), share(robot.contact_robot, robot.states),
               share(robot.contact_wall, robot.states), share(robot.limited, robot.states),
               std::to_string(robot.limited), share(robot.stopped, robot.states),
               share(robot.lease_expired, robot.states), std::to_string(robot.boots)});
  }
  return "<h2>Robots</h2>\n<p>As reported by the robots; percentages are shares of their reports. "
         "Only simulated robots report contacts. Limited: since the report before, a wheel speed "
         "was "
         "beyond what the wheels reach, or the program's arithmetic was limited: a result too "
         "large, "
         "a division by 0, an impossible draw, a hold beyond 0 s to 1 h or too short for the "
         "robot's "
         "computing.</p>\n" +
         table.text();
}

std::string serialLines(const RunRecord& record) {
  if (record.serial_lines.empty()) return {};
  Table table({"robot", ">frames received", ">lost", ">with errors"});
  for (const SerialLine& line : record.serial_lines) {
    table.row({escapeHtml(line.text), groupedText(line.received), groupedText(line.lost),
               groupedText(line.decode_errors)});
  }
  return "<h2>Serial lines</h2>\n<p>Robots on serial lines, with the programs that they loaded at "
         "the start of the run and the time that this took.</p>\n" +
         table.text();
}

std::string losses(const RunRecord& record) {
  std::string html = "<h2>Message loss</h2>\n";
  const std::string lost = lossText(record);
  html += fmt::format("<p>{}. {}</p>\n",
                      lost.empty() ? "Every message that was sent is in the log" : sentence(lost),
                      record.missing_frames == 0
                          ? "The camera’s frame numbers have no gap."
                          : fmt::format("The camera’s frame numbers have gaps: {} missing of {}.",
                                        countText(record.missing_frames, "frame"),
                                        groupedText(record.log.frames + record.missing_frames)));
  Table table({"sender", ">start", "channel", ">in the log", ">lost", ">largest age (ms)"});
  for (const StreamLoss& stream : record.log.streams) {
    table.row({escapeHtml(stream.sender), std::to_string(stream.start), escapeHtml(stream.channel),
               groupedText(stream.received),
               (stream.at_least ? "≥ " : "") + groupedText(stream.lost),
               fmt::format("{:.1f}", stream.largest_age * 1e3)});
  }
  html +=
      table.text() +
      "<p class=\"soft\">Age is the time from the measurement (such as the exposure of a frame) "
      "to the arrival at the logger. ≥ marks a sender that did not end cleanly: its last count "
      "is unknown, and more messages may be lost.</p>\n";
  if (!record.log.decode_errors.empty()) {
    Table errors({"channel", ">messages that could not be decoded"});
    for (const auto& [channel, count] : record.log.decode_errors) {
      errors.row({escapeHtml(channel), groupedText(count)});
    }
    html += errors.text();
  }
  if (!record.listeners.empty()) {
    html += "<p>Messages that the services missed during the run:</p>\n";
    Table heard({"listener", "channel", "sender", ">lost", ">not decoded"});
    for (const ListenerLoss& loss : record.listeners) {
      heard.row({escapeHtml(loss.listener), escapeHtml(loss.channel), escapeHtml(loss.sender),
                 groupedText(loss.lost), groupedText(loss.decode_errors)});
    }
    html += heard.text();
  }
  return html;
}

std::string links(const RunRecord& record) {
  if (record.links.empty()) return {};
  const auto inMilliseconds = [](double seconds) {
    return std::isfinite(seconds) ? fmt::format("{:.2f}", seconds * 1e3) : std::string("–");
  };
  Table table({"host", "other host", ">messages", ">lost", ">duplicates", ">too late", ">not sent",
               ">interruptions", ">clock of the other host (ms)", ">round trip (ms)", ""});
  for (const LinkRecord& link : record.links) {
    table.row({escapeHtml(link.host), escapeHtml(link.peer), groupedText(link.received),
               groupedText(link.lost), groupedText(link.repeated), groupedText(link.stale),
               groupedText(link.timeouts), std::to_string(link.interruptions),
               inMilliseconds(link.lowest_offset) + " to " + inMilliseconds(link.highest_offset),
               inMilliseconds(link.round_trip), escapeHtml(link.trouble)});
  }
  return "<h2>Links between hosts</h2>\n" + table.text() +
         "<p class=\"soft\">The table counts the messages that this host received from the other "
         "one. Duplicates, and commands that came too late, were dropped. “Not sent” counts the "
         "messages of this host that DDS could not send in time, to all other hosts together. The "
         "clock column is the clock of the other host minus that of this one: the lowest and the "
         "highest value of the run.</p>\n";
}

std::string poseSource(const RunRecord& record) {
  const PoseSource& poses = *record.poses;
  std::string html = fmt::format(
      "<h2>Provenance</h2>\n<p>The file of poses has {} in {}; {}. It was analyzed by Active Lab "
      "{}.</p>\n<ul>\n",
      countText(poses.rows, "row"), countText(record.log.frames, "frame"),
      record.missing_frames == 0 ? "the frame numbers have no gap"
                                 : fmt::format("by the frame numbers, {} missing",
                                               countText(record.missing_frames, "frame")),
      kVersion);
  if (poses.without_pose > 0) {
    html += fmt::format("<li>Omitted: {} without a number for the position or the heading.</li>\n",
                        countText(poses.without_pose, "row"));
  }
  if (poses.without_id > 0) {
    html += fmt::format("<li>Omitted: {} without a track (id 0).</li>\n",
                        countText(poses.without_id, "row"));
  }
  if (poses.repeated > 0) {
    html += fmt::format("<li>Omitted: {} with the content of another row.</li>\n",
                        countText(poses.repeated, "row"));
  }
  if (poses.contradicted > 0) {
    html += fmt::format("<li>Omitted: {} of robots that have two positions in one frame.</li>\n",
                        countText(poses.contradicted, "pose"));
  }
  if (!poses.headings) {
    html +=
        "<li>The file has no headings: there is no angular MSD, no speed along the heading and no "
        "D<sub>r</sub>. The tracker noise is taken from the fit; without a fit nothing is "
        "judged.</li>\n";
  }
  if (poses.bad_times > 0) {
    html += fmt::format("<li>Omitted: {} whose time does not increase.</li>\n",
                        countText(poses.bad_times, "frame"));
  }
  if (poses.clock_steps > 0) {
    html += fmt::format(
        "<li>The time column jumps against the frame numbers at {}: the tracks are cut "
        "there.</li>\n",
        countText(poses.clock_steps, "place"));
  }
  html +=
      record.programs.front().program.hash == 0
          ? "<li>Without a program, reversals cannot be distinguished from the other motion: they "
            "are part of the curves.</li>\n"
          : fmt::format(
                "<li>{} recognised: straight motion at constant speed that the program cannot "
                "produce.</li>\n",
                countText(poses.reversals, "reversal"));
  return html +
         "<li>Contacts are determined by distance only.</li>\n<li>There is no robot status. The "
         "report assumes that all robots ran the given program all the time.</li>\n</ul>\n";
}

std::string provenance(const RunRecord& record) {
  std::string html = "<h2>Provenance</h2>\n";
  Table services({"service", ">start", "kind", "version", "ended", "last error"});
  for (const ServiceRecord& service : record.services) {
    services.row({escapeHtml(service.name), std::to_string(service.start),
                  originName(service.origin), escapeHtml(service.version),
                  service.ended ? "cleanly" : "<span class=\"deviates\">not cleanly</span>",
                  escapeHtml(service.last_error)});
  }
  if (!record.services.empty()) html += services.text();
  html += fmt::format(
      "<p>The run was recorded by Active Lab {} and analyzed by version {}; message contract {}. "
      "{}This page was made from the log alone. This command makes an identical copy:</p>\n"
      "<pre>{} analyze RUN</pre>\n",
      record.version.empty() ? "of unknown version" : "version " + escapeHtml(record.version),
      kVersion,
      record.contract_version == 0 ? "not stated" : std::to_string(record.contract_version),
      record.calibration.empty()
          ? ""
          : fmt::format("Projector calibration {}. ", escapeHtml(record.calibration)),
      installation().command);
  if (record.experiment && record.log.virtual_time) {
    html += fmt::format(
        "<p>The run took place in virtual time. This command repeats it with an identical "
        "result:</p>\n"
        "<pre>{} run RUN/experiment.toml --virtual-time</pre>\n",
        installation().command);
  }
  if (!record.experiment_text.empty()) {
    html += fmt::format(
        "<details><summary>Experiment file of this run, with all defaults</summary>\n<pre>{}</pre>"
        "</details>\n",
        escapeHtml(record.experiment_text));
  }
  return html;
}

}  // namespace lab::report::html
