#include "analyzer/report/summary/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "analyzer/report/record/crowd_records.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

using analysis::CurvePoint;
using analysis::Estimate;
using analysis::ProgramResult;
using analysis::VerdictKind;
using units::kCm;
using units::kPercents;

constexpr std::int64_t kMuchOneIn = 10;  // a larger share of omitted poses biases the estimates

std::string uniqueFile(const std::vector<Finding>& before, const std::string& name) {
  const std::string word = sanitizedFileName(name);
  std::string file = word;
  const auto taken = [&] {
    return std::any_of(before.begin(), before.end(),
                       [&](const Finding& other) { return other.file == file; });
  };
  for (int number = 2; taken(); ++number) file = fmt::format("{}_{}", word, number);
  return file;
}

int keyOf(const RunRecord& record, const program_id_t& program) {
  const auto known =
      std::find_if(record.programs.begin(), record.programs.end(),
                   [&](const RunProgram& one) { return one.program.hash == program.hash; });
  return known == record.programs.end() ? -1 : static_cast<int>(known - record.programs.begin());
}

/// "D_r = 0.748 rad²/s (95 %: 0.736 to 0.760; programmed 0.75)"
std::string estimateText(const Estimate& estimate) {
  const DisplayUnit unit = displayUnit(estimate.unit);
  const double error = (estimate.high95 - estimate.low95) / 2 * unit.factor;
  const std::string programmed =
      std::isfinite(estimate.theory)
          ? fmt::format("; programmed {}", shortText(estimate.theory * unit.factor))
          : "";
  return fmt::format("{} = {}{}{} (95 %: {} to {}{})", estimate.name,
                     valueText(estimate.value * unit.factor, error), unit.text.empty() ? "" : " ",
                     unit.text, valueText(estimate.low95 * unit.factor, error),
                     valueText(estimate.high95 * unit.factor, error), programmed);
}

/// The point of a curve whose lag is nearest to 10 s.
template <class Point>
const Point& aroundTenSeconds(const std::vector<Point>& curve) {
  constexpr double kLag = 10;  // s
  return *std::ranges::min_element(
      curve, {}, [](const Point& point) { return std::abs(std::log(point.tau / kLag)); });
}

/// "speed 0.34 cm/s, MSD 2.1 cm² in 10 s"
std::string motionText(double speed, double msd, double tau) {
  std::vector<std::string> parts;
  if (std::isfinite(speed)) parts.push_back(fmt::format("speed {:.3g} cm/s", speed * kCm));
  if (std::isfinite(msd)) {
    parts.push_back(fmt::format("MSD {:.3g} cm² in {} s", msd * kCm * kCm, shortText(tau)));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// A remark if the measured speed differs from the programmed one, because curves are compared at
/// the measured speed.
std::vector<std::string> speedRemark(const ProgramResult& result) {
  for (const Estimate& estimate : result.estimates) {
    const bool is_speed = estimate.name == "v" || estimate.name == "v_a";
    if (!is_speed || !(estimate.theory > 0)) continue;
    const bool outside = estimate.theory < estimate.low95 || estimate.theory > estimate.high95;
    const double off = estimate.value / estimate.theory - 1;
    if (!outside || std::abs(off) > analysis::CurveOptions{}.speed_tolerance) continue;
    return {fmt::format(
        "The measured speed differs from the programmed speed by {:+.2f} %. Steps of the wheel "
        "speeds or clock errors can cause this. The curves are therefore compared with the exact "
        "law at the measured speed.",
        off * kPercents)};
  }
  return {};
}

}  // namespace

std::vector<Finding> findingsOf(const RunRecord& record) {
  std::vector<Finding> findings;
  for (const analysis::FeedResult& result : record.results) {
    if (result.result.robot == analysis::kPool) {
      Finding finding;
      finding.key = keyOf(record, result.program);
      finding.name = finding.key < 0 ? result.program.name : record.programNameOf(finding.key);
      if (finding.key >= 0) {
        finding.colour = record.programs[static_cast<std::size_t>(finding.key)].colour;
      }
      const analysis::ProgramLaw& law = result.result.law;
      finding.model = law.known() ? law->title() : "program not given";
      finding.file = uniqueFile(findings, finding.name);
      finding.pool = &result;
      findings.push_back(std::move(finding));
    } else if (!findings.empty() && findings.back().pool->result.robots > 1) {
      findings.back().robots.push_back(&result);
    }
  }
  return findings;
}

std::string restriction(const ProgramResult& result) {
  const analysis::TimeShares& shares = result.shares;
  if (shares.cut() <= analysis::kMuchCut) return {};
  std::vector<std::string> parts;
  for (const auto& [what, share] :
       {std::pair("contact", shares.contact), std::pair("reversing", shares.reversing),
        std::pair("stopped", shares.stopped)}) {
    constexpr double kLeast = 0.0005;  // shown as 0.1 %
    if (share >= kLeast) parts.push_back(fmt::format("{} {:.1f} %", what, share * kPercents));
  }
  return fmt::format("{:.1f} % of the time is not free motion ({})", shares.cut() * kPercents,
                     fmt::join(parts, ", "));
}

std::string wholeMotionText(const ProgramResult& result) {
  if (!result.whole || result.whole->lags.empty()) return {};
  const analysis::WholeLag& lag = aroundTenSeconds(result.whole->lags);
  return motionText(result.whole->speed, lag.msd, lag.tau);
}

std::string freeMotionText(const ProgramResult& result) {
  if (result.curves.msd.empty()) return {};
  const CurvePoint& point = aroundTenSeconds(result.curves.msd);
  double speed = units::kNan;
  for (const Estimate& estimate : result.estimates) {
    if (estimate.name == "v" || estimate.name == "v_a") speed = estimate.value;
  }
  return motionText(speed, point.value, point.tau);
}

bool isRestricted(const ProgramResult& result) {
  const analysis::TimeShares& shares = result.shares;
  return shares.contact > analysis::kMuchCut || shares.reversing > shares.free;
}

std::string verdictText(const ProgramResult& result) {
  if (!result.law.known() || !result.no_verdict.empty()) return "no law to compare with";
  switch (result.verdict.kind) {
    case VerdictKind::kAgrees:
      return "agrees with " + result.law->reference();
    case VerdictKind::kDisagrees:
      return "deviates from " + result.law->reference();
    default:
      return "undecided";
  }
}

std::string speedAllowance(const ProgramResult& result) {
  const std::optional<double> programmed = result.law->constantSpeed();
  if (!programmed || !(*programmed > 0)) return {};
  for (const Estimate& estimate : result.estimates) {
    if (estimate.name != "v" || !std::isfinite(estimate.value)) continue;
    return fmt::format("speed {:+.2f} % from the programmed one, up to {:g} % allowed",
                       (estimate.value / *programmed - 1) * kPercents,
                       analysis::CurveOptions{}.speed_tolerance * kPercents);
  }
  return {};
}

std::string misfitText(const ProgramResult& result) {
  const analysis::Verdict& verdict = result.verdict;
  if (verdict.misfit) {
    return fmt::format("no parameters of the law describe the curves (p = {:.0e})",
                       result.fit->p_value);
  }
  if (verdict.rejected) {
    return fmt::format("p = {:.0e} for the programmed parameters", result.fit->exact->p_value);
  }
  return {};
}

std::string verdictReason(const ProgramResult& result) {
  const analysis::Verdict& verdict = result.verdict;
  if (!result.law.known()) {
    return "No program was given, so there are curves without theory. Name the program with "
           "--program and --set.";
  }
  if (!result.no_verdict.empty()) return result.no_verdict;
  if (result.shares.contact > analysis::kMostlyContact) {
    return "Robots were in contact most of the time. What is left is a biased sample of the "
           "motion, "
           "so there is no verdict. Use fewer robots, or programs that come free of walls.";
  }
  if (verdict.kind == VerdictKind::kUndecided) {
    return fmt::format(
        "Not enough data: {} can be judged. A verdict needs five, and at least a hundred draws of "
        "wheel speeds (or a hundred tumbles).",
        countText(verdict.judged, "lag"));
  }
  const std::string where = verdict.draws ? "shape of the draws: kurtosis of the turning rate"
                            : verdict.turning
                                ? "mean turning rate: it circles"
                                : fmt::format("{} {} s",
                                              verdict.hold      ? "time between draws, measured"
                                              : verdict.angular ? "angular MSD at"
                                                                : "MSD at",
                                              shortText(verdict.tau));
  std::string reason = fmt::format(
      "The largest deviation from {} at {} is {:.1f} standard errors ({}). By "
      "chance alone one run in a hundred exceeds 3.2. From 4 on, the motion deviates.",
      result.law->reference(), countText(verdict.judged, "judged lag"), std::abs(verdict.max_z),
      where);
  if (verdict.misfit) {
    reason += fmt::format(
        " No parameters of the law describe the curves (goodness of fit p = {:.0e}; from 0.001 on "
        "they do), so the numbers that follow from the law are not those of this motion.",
        result.fit->p_value);
  } else if (verdict.rejected) {
    reason += fmt::format(
        " The data reject the programmed parameters (p = {:.0e}; from 0.001 on they do not).",
        result.fit->exact->p_value);
  }
  const std::string speed = speedAllowance(result);
  if (!speed.empty()) reason += fmt::format(" Compared at the measured speed: {}.", speed);
  return reason;
}

std::vector<std::string> caveats(const ProgramResult& result) {
  std::vector<std::string> remarks = speedRemark(result);
  if (result.unbiased_lag > 0) {
    remarks.push_back(
        fmt::format("The light depends on the position, so how a robot moves decides how long it "
                    "runs this program. Windows longer than {} s are therefore a biased sample. "
                    "They are drawn hollow and not judged.",
                    shortText(result.unbiased_lag)));
  }
  if (result.reversals > 0) {
    remarks.push_back(
        fmt::format("{} at walls or robots removed, and the track joined there. After a reversal a "
                    "robot continues its program where it was interrupted, so the joined track has "
                    "the statistics of free motion.",
                    countText(result.reversals, "reversal")));
  }
  if (result.contact_share > 0) {
    remarks.push_back(
        fmt::format("{:.1f} % of the frames were cut because of contact with a robot or a wall. "
                    "The motion between contacts is a biased sample: it lies in free space{}.",
                    result.contact_share * kPercents,
                    result.law->runs()
                        ? ", and its runs are short, because contacts end runs. In a crowd gamma "
                          "is therefore overestimated, and the motion may deviate from the law "
                          "although the robots work correctly"
                        : ""));
  }
  if (result.lost > 0) {
    remarks.push_back(fmt::format(
        "{} omitted: the robot did not report its program for that time, or the position jumped "
        "farther than wheels can drive.",
        countText(result.lost, "frame")));
  }
  constexpr int kFewPhases = 4;
  const int in_step = result.curves.frames_in_step;
  if (in_step > 0 && in_step <= kFewPhases) {
    remarks.push_back(fmt::format(
        "The frames keep step with the holds: after {} they lie at the same phases of a hold. "
        "Curves at short lags then depend on these phases, which more recording does not average "
        "out; their errors and those of the fit contain it. Another frame rate avoids it.",
        countText(in_step, "frame")));
  }
  const double noise = result.curves.msd.empty() ? 0 : result.curves.msd.front().noise;
  if (std::isfinite(noise) && noise > 0) {
    remarks.push_back(
        fmt::format("The measured tracker noise of {} cm per coordinate is taken into account.",
                    fmt::format("{:.2g}", std::sqrt(noise) / 2 * kCm)));
  }
  return remarks;
}

const Estimate* characteristicEstimate(const ProgramResult& result) {
  const std::string name = result.law.known() ? result.law->characteristicEstimate() : "v";
  const auto found = std::find_if(
      result.estimates.begin(), result.estimates.end(),
      [&](const Estimate& one) { return one.name == name && std::isfinite(one.value); });
  return found == result.estimates.end() ? nullptr : &*found;
}

std::string paperComparison(const ProgramResult& result) {
  const std::string formula = result.law->paperFormula();
  const CurvePoint* furthest = nullptr;
  double most = 0;
  double most_z = 0;
  for (const CurvePoint& point : result.curves.msd) {
    const double off = point.paper / point.exact - 1;
    if (!point.judged || !std::isfinite(off) || !(point.sigma > 0)) continue;
    if (std::abs(off) > std::abs(most)) {
      most = off;
      furthest = &point;
    }
    most_z = std::max(most_z, std::abs(point.paper - point.exact) / point.sigma);
  }
  if (formula.empty()) return {};
  if (furthest == nullptr || std::abs(most) < 1e-6) {
    return result.verdict.judged == 0
               ? std::string()
               : fmt::format("The paper's {} is the exact law here.", formula);
  }
  return fmt::format(
      "The paper's {} differs from the exact law by up to {:+.{}f} % (at {} s); in this run, that "
      "is at most {} standard errors.",
      formula, most * kPercents, std::abs(most) < 0.1 ? 1 : 0, shortText(furthest->tau),
      most_z < 10 ? fmt::format("{:.1f}", most_z) : fmt::format("{:.0f}", most_z));
}

std::string parametersText(const analysis::FeedResult& result) {
  std::vector<std::string> parts;
  const std::vector<analysis::LawParameter>& known = result.result.law->parameters();
  for (const ProgramParameter& parameter : result.definition.parameters) {
    const auto same = std::ranges::find(known, parameter.name, &analysis::LawParameter::name);
    const DisplayUnit unit = displayUnit(parameter.unit);
    const std::string& symbol = same == known.end() ? parameter.name : same->symbol;
    parts.push_back(fmt::format("{} = {}{}{}", symbol, shortText(parameter.value * unit.factor),
                                unit.text.empty() ? "" : " ",
                                unit.text == "1/s" ? "/s" : unit.text));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string lossText(const RunRecord& record) {
  const LossTotal total = totalOf(record.log.streams);
  if (total.lost == 0 && !total.at_least) return {};
  if (total.lost == 0) {
    return "no loss was found, but a sender ended without its last count";
  }
  const std::int64_t sent = total.lost + total.received;
  const double percents = kPercents * static_cast<double>(total.lost) / static_cast<double>(sent);
  return fmt::format("{}{} of {} ({:.{}g} %) missing in the log", total.at_least ? "at least " : "",
                     groupedText(total.lost), countText(sent, "message"), percents,
                     percents < 99 ? 2 : 4);
}

std::vector<std::string> refusalTexts(const RunRecord& record) {
  std::vector<std::string> lines;
  for (const auto& [channel, refused] : record.log.refused) {
    std::string what = refused.count > 0 ? countText(refused.count, "message") : "";
    if (refused.robots > 0) {
      what += (what.empty() ? "" : " and ") + countText(refused.robots, "robot");
    }
    lines.push_back(fmt::format("{} on {} not used: the first {}", what, channel, refused.first));
  }
  if (record.log.bad_times > 0) {
    lines.push_back(fmt::format("{} of arrival damaged: replaced by the one before",
                                countText(record.log.bad_times, "time")));
  }
  if (record.log.foreign_senders > 0) {
    lines.push_back(fmt::format("{} of senders beyond the first {} not counted among the losses",
                                countText(record.log.foreign_senders, "message"),
                                MessageLossCounter::kMostSenders));
  }
  if (record.left_out > 0) {
    lines.push_back(
        fmt::format("{} of robots and programs beyond {} robots and {} programs left "
                    "out",
                    countText(record.left_out, "report"), analysis::Analysis::kMostRobots,
                    analysis::Analysis::kMostPrograms));
  }
  if (!record.crowds.empty() && record.crowd_left_out > 0) {
    const std::string why =
        isCrowdCut(record)
            ? fmt::format(", which are of the first {} of up to {} robots of a frame",
                          collective::CrowdAnalysis::kMostRobots, groupedText(record.crowd_most))
            : ": outside of the arena, or of a robot that is twice in its frame";
    lines.push_back(fmt::format("{} not in the collective numbers{}",
                                countText(record.crowd_left_out, "pose"), why));
  }
  return lines;
}

std::vector<std::string> headlines(const RunRecord& record) {
  std::vector<std::string> lines;
  // First, because doubts about units concern all numbers that follow.
  if (record.poses) lines = record.poses->doubts;
  const auto findings = findingsOf(record);
  std::int64_t jumped = 0;
  for (const Finding& finding : findings) jumped += finding.pool->result.lost;
  const bool selected = record.poses && jumped * kMuchOneIn > record.poses->rows;
  for (const Finding& finding : findings) {
    const ProgramResult& result = finding.pool->result;
    std::string line = finding.name + ": ";
    const std::string limits = restriction(result);
    if (!limits.empty()) {
      const std::string whole = wholeMotionText(result);
      const std::string free = freeMotionText(result);
      line += fmt::format("{}; {}free motion: {}", limits,
                          whole.empty() ? "" : fmt::format("whole motion: {}; ", whole),
                          free.empty() ? "" : free + ", ");
    }
    line += verdictText(result);
    if (result.verdict.kind != VerdictKind::kUndecided) {
      line += fmt::format(", at most {:.1f} standard errors over {}",
                          std::abs(result.verdict.max_z), countText(result.verdict.judged, "lag"));
      for (const std::string& part : {misfitText(result), speedAllowance(result)}) {
        if (!part.empty()) line += "; " + part;
      }
    }
    const Estimate* estimate = selected ? nullptr : characteristicEstimate(result);
    if (estimate != nullptr) line += "; " + estimateText(*estimate);
    if (estimate != nullptr && result.verdict.misfit)
      line += ", by a law that does not describe it";
    lines.push_back(line);
  }
  const bool any = !findings.empty();
  if (!any && record.poses && record.poses->in_contact > 0) {
    lines.push_back(
        fmt::format("no free motion: {} of {} touch another robot or a wall of the {:g} x {:g} cm "
                    "arena (another "
                    "one: --set arena.width_cm=... --set arena.height_cm=...)",
                    groupedText(record.poses->in_contact), countText(record.poses->rows, "pose"),
                    record.experimentOrDefault().arena_width * kCm,
                    record.experimentOrDefault().arena_height * kCm));
  } else if (!any) {
    lines.emplace_back(
        "no robot was tracked while it ran a program of motion: "
        "nothing to compare");
  }
  if (record.poses) {
    const PoseSource& poses = *record.poses;
    if (any && poses.in_contact * kMuchOneIn > poses.rows) {
      lines.push_back(
          fmt::format("{} of {} touch another robot or a wall of the {:g} x {:g} cm arena: only "
                      "the motion between contacts is judged (another arena: --set "
                      "arena.width_cm=... --set arena.height_cm=...)",
                      groupedText(poses.in_contact), countText(poses.rows, "pose"),
                      record.experimentOrDefault().arena_width * kCm,
                      record.experimentOrDefault().arena_height * kCm));
    }
    if (selected) {
      lines.push_back(fmt::format(
          "{} of {} omitted: faster than wheels can drive or turn a robot, so the remaining poses "
          "are a biased sample. Is the unit of x and y right (--scale-cm)? Are headings in "
          "radians?",
          groupedText(jumped), countText(poses.rows, "pose")));
    }
    for (const auto& [count, what] :
         {std::pair(poses.repeated, "repeated within a frame: counted once"),
          std::pair(poses.contradicted, "of a robot at two positions in one frame: omitted")}) {
      if (count > 0) lines.push_back(fmt::format("{} {}", countText(count, "pose"), what));
    }
    if (record.missing_frames > 0) {
      lines.push_back(fmt::format("{} missing in the frame numbers",
                                  countText(record.missing_frames, "frame")));
    }
    for (const std::string& line : refusalTexts(record)) lines.push_back(line);
    return lines;
  }
  for (const std::string& line : refusalTexts(record)) lines.push_back(line);
  const std::string lost = lossText(record);
  lines.push_back(lost.empty() ? "all messages that were sent are in the log" : lost);
  for (const Remark& fault : record.faults) {
    lines.push_back(fmt::format("fault at {:.1f} s: {}", record.seconds(fault.utime), fault.text));
  }
  if (!record.ended) lines.emplace_back("the run has no END event: it was cut short");
  return lines;
}

}  // namespace lab::report
