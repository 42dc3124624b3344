#include "analyzer/law_knowledge.hpp"

#include "analyzer/curves/estimates.hpp"
#include "analyzer/laws/law_of.hpp"
#include "analyzer/laws/law_problem.hpp"

namespace lab::analysis {

LawKnowledge lawKnowledge() {
  return {lawProblems, [](const Program& program, double wheel_base) {
            return estimateNames(lawOf(program, wheel_base));
          }};
}

}  // namespace lab::analysis
