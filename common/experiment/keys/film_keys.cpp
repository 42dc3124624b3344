#include "common/experiment/keys/film_keys.hpp"

#include <array>
#include <cstdint>
#include <utility>

namespace lab::keys {
namespace {

const std::array<Choice, 3> kFilmCodecs = {{choiceOf("ffv1", FilmCodec::kFfv1),
                                            choiceOf("ffvhuff", FilmCodec::kFfvhuff),
                                            choiceOf("h264", FilmCodec::kH264)}};

}  // namespace

void visitFilm(KeyVisitor& v, const Selector& tracker, FilmSpec& film) {
  const auto key = [&, differs = !(film == FilmSpec{})](Key one) {
    if (!differs) one.need = Need::kShorthand;
    return tracker.only({Tracker::kCamera}, std::move(one));
  };
  v.flag(
      key({"record", "keep a film of what the tracker saw, in the run's folder (docs/films.md)"}),
      film.record);
  enumerate(v,
            key({"record_codec",
                 "codec of the film; ffv1: lossless, small; ffvhuff: lossless, a fifth of the "
                 "work; h264: loses detail, much smaller"}),
            kFilmCodecs, film.codec);
  std::int64_t crf = film.crf;
  v.integer(key({"record_crf", "quality of h264, its constant rate factor; more: smaller, worse"}),
            1, 51, crf);
  film.crf = static_cast<int>(crf);
  v.number(key({"record_most_GB",
                "size of the film, or of those of all cameras, at which it ends, in 1e9 bytes"}),
           {0.001, 100'000}, film.most_GB);
  std::int64_t threads = film.threads;
  v.integer(key({"record_threads", "threads of the encoder, at most"}), 1, 16, threads);
  film.threads = static_cast<int>(threads);
}

}  // namespace lab::keys
