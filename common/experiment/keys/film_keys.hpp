/// The keys of the film of a run.
#pragma once

#include "common/experiment/experiment.hpp"
#include "common/experiment/keys/key_helpers.hpp"

namespace lab::keys {

/// They are written only where one of them differs from its default: other runs keep their text,
/// and so the bytes of their logs.
/// @param tracker the choice of [camera] on which they depend
void visitFilm(KeyVisitor& v, const Selector& tracker, FilmSpec& film);

}  // namespace lab::keys
