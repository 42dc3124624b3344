/// The keys of the light script, of the rules that end a run, and of the projector.
#pragma once

#include "common/experiment/keys/experiment_form.hpp"
#include "common/experiment/keys/key_visitor.hpp"

namespace lab::keys {

void visitLight(KeyVisitor& v, ExperimentForm& form);
void visitStopOn(KeyVisitor& v, StopOn& on);
void visitStopRule(KeyVisitor& v, StopRule& rule);
void visitProjector(KeyVisitor& v, Projector& projector);

}  // namespace lab::keys
