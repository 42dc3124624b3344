#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "analyzer/report/html/html_sections.hpp"
#include "common/text/format.hpp"

namespace lab::report::html {
namespace {

std::string codecText(const FilmFacts& film) {
  const std::string codec = escapeHtml(film.codec);
  return film.lossless() ? codec + ", lossless" : fmt::format("{}, crf {}", codec, film.crf);
}

/// [s] that the films of the other cameras go on for after it
double missingEnd(const FilmFacts& film, const std::vector<FilmFacts>& all) {
  std::int64_t last = film.last_utime;
  for (const FilmFacts& other : all) {
    if (other.start_utime == film.start_utime) last = std::max(last, other.last_utime);
  }
  return static_cast<double>(last - film.last_utime) * 1e-6;
}

std::string filmSentence(const FilmFacts& film, const std::vector<FilmFacts>& all) {
  std::string text = film.camera.empty() ? "" : "Camera " + escapeHtml(film.camera) + ": ";
  text += fmt::format(
      "{} frames of {} × {} px in {} ({}), {:.3g} GB; recording them took {:.2g} processor cores.",
      groupedText(film.frames), film.format.width, film.format.height,
      durationText(film.duration()), codecText(film), static_cast<double>(film.bytes) * 1e-9,
      film.duration() > 0 ? film.cpu / film.duration() : 0);
  text += film.lost == 0 ? " No frame was lost."
                         : fmt::format(" <b>{} frames were lost</b>, because the encoder was busy.",
                                       groupedText(film.lost));
  if (!film.problem.empty()) {
    text += fmt::format(" <b>The film ends early:</b> {}; it lacks the last {} frames.",
                        escapeHtml(film.problem), groupedText(film.after_end));
  }
  constexpr double kNoticeable = 1;  // [s]
  if (const double missing = missingEnd(film, all); missing > kNoticeable && film.problem.empty()) {
    text += fmt::format(" <b>The film ends {} before those of the other cameras.</b>",
                        durationText(missing));
  }
  if (!film.complete) text += " The tracker was ended before the film was complete.";
  return "<p>" + text + "</p>\n";
}

}  // namespace

std::string film(const RunRecord& record) {
  if (record.films.empty()) return {};
  std::string html = "<h2>Film</h2>\n";
  if (!record.film_note.empty()) {
    html +=
        fmt::format("<p><b>The poses of this report were tracked again from the film:</b> {}</p>\n",
                    escapeHtml(record.film_note));
  }
  for (const FilmFacts& film : record.films) html += filmSentence(film, record.films);
  if (record.film_stills) {
    html +=
        "<figure><img src=\"film.jpg\" alt=\"Stills of the film\" style=\"max-width:100%\">"
        "<figcaption><b>Stills.</b> Green: both circles of a cap were measured; blue: a light edge "
        "crosses one; orange: a degraded pose. Times count from the first message of the "
        "log.</figcaption></figure>\n";
  }
  if (record.film_clip) {
    html +=
        "<figure><video src=\"film.mp4\" controls muted loop style=\"max-width:100%\"></video>"
        "<figcaption><b>The run sped up</b>, at most 10 s long (film.mp4 beside this "
        "page).</figcaption></figure>\n";
  }
  return html;
}

}  // namespace lab::report::html
