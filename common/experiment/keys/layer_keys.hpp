/// The keys of a light layer.
#pragma once

#include "common/experiment/keys/experiment_form.hpp"
#include "common/experiment/keys/key_visitor.hpp"

namespace lab::keys {

void visitLayer(KeyVisitor& v, LayerEntry& entry);

}  // namespace lab::keys
