/// The keys of the table [sweep].
#pragma once

#include "common/experiment/keys/key_visitor.hpp"
#include "common/experiment/sweep.hpp"

namespace lab::keys {

void visitSweep(KeyVisitor& v, SweepTable& sweep);

}  // namespace lab::keys
