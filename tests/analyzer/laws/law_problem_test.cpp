#include "analyzer/laws/law_problem.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "analyzer/law_knowledge.hpp"
#include "analyzer/laws/closed_forms.hpp"
#include "common/programs/shipped_programs.hpp"

namespace lab::analysis::law_problem_test {
namespace {

using language::NamedText;
using language::ProgramText;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// "key: message" of each problem of a shipped program with this law.
std::vector<std::string> problemsOf(const std::vector<NamedText>& law,
                                    const std::string& program = "rtp",
                                    const LagRange& lags = LagRange()) {
  ProgramText text = shippedProgramText(program).value();
  text.law = law;
  const language::CompiledProgram compiled = language::compile(text);
  EXPECT_TRUE(compiled.ok()) << compiled.errors[0].message;
  std::vector<std::string> lines;
  for (const language::Problem& problem : lawProblems(text, compiled, lags)) {
    EXPECT_EQ(problem.message.find('\n'), std::string::npos);
    lines.push_back(problem.key + ": " + problem.message);
  }
  return lines;
}

TEST(LawProblem, AcceptsTheShippedPrograms) {
  for (const std::string& name : shippedProgramNames()) {
    const ProgramText text = shippedProgramText(name).value();
    EXPECT_THAT(lawProblems(text, language::compile(text), LagRange()), IsEmpty()) << name;
  }
}

TEST(LawProblem, AcceptsAClosedFormWithOtherNamesAndFurtherParametersOfTheProgram) {
  EXPECT_THAT(problemsOf({{"name", "rtp"}, {"v", "v"}, {"gamma", "1/tau_t"}, {"tau_t", "tau_t"}}),
              IsEmpty());
  ProgramText text = shippedProgramText("rtp").value();
  text.parameters.emplace_back("unused", "3 cm");
  EXPECT_THAT(lawProblems(text, language::compile(text), LagRange()), IsEmpty());
}

TEST(LawProblem, NamesTheClosedFormThatWasMeant) {
  EXPECT_THAT(problemsOf({{"name", "rtpp"}}),
              ElementsAre("law.name: found \"rtpp\", expected the name of a closed form (abp, "
                          "noisy_abp, bp, rtp), formulas as in law = {msd = \"...\"}, or no law: "
                          "then the reference is simulated; did you mean rtp?"));
}

TEST(LawProblem, NamesParametersThatAreMissingOrUnknown) {
  EXPECT_THAT(problemsOf({{"name", "abp"}}),
              ElementsAre(StartsWith("law: found no epsilon (s), expected all parameters of "
                                     "\"abp\": v (m/s), epsilon (s), eta (rad/s); the program has "
                                     "v, gamma, tau_t: write law = {name = \"abp\", v = \"v\", "
                                     "epsilon = \"...\", eta = \"...\"}"),
                          StartsWith("law: found no eta (rad/s)")));
  EXPECT_THAT(problemsOf({{"name", "rtp"}, {"v", "v"}, {"gama", "gamma"}, {"tau_t", "tau_t"}}),
              ElementsAre("law.gama: found an unknown parameter of \"rtp\", expected v (m/s), "
                          "gamma (1/s), tau_t (s); did you mean gamma?",
                          HasSubstr("law: found no gamma (1/s)")));
}

TEST(LawProblem, ComparesUnits) {
  EXPECT_THAT(
      problemsOf({{"name", "rtp"}, {"v", "v"}, {"gamma", "tau_t"}, {"tau_t", "tau_t"}}),
      ElementsAre("law.gamma: found a number in s, expected a number in 1/s for gamma of the law "
                  "\"rtp\"; write an expression of the program's parameters with this unit"));
}

TEST(LawProblem, EvaluatesFormulasOverTheLags) {
  EXPECT_THAT(problemsOf({{"msd", "v*v*tau*tau"}, {"angular_msd", "tau*gamma"}}), IsEmpty());
  EXPECT_THAT(problemsOf({{"msd", "v*v*tau*(tau_t - tau)"}}),
              ElementsAre(StartsWith("law.msd: is -")));
  EXPECT_THAT(problemsOf({{"msd", "v*v*tau*(tau_t - tau)"}}),
              ElementsAre(HasSubstr("expected 0 or more at all lags from 0.03333 s to 100 s")));
  EXPECT_THAT(problemsOf({{"msd", "v*v*tau*(tau_t - tau)"}}, "rtp", {0.01, 0.5}), IsEmpty());
  EXPECT_THAT(problemsOf({{"angular_msd", "exp(tau/(1 ms))"}}),
              ElementsAre(StartsWith("law.angular_msd: is no finite number at tau = ")));
  EXPECT_THAT(problemsOf({{"msd", "v*v*tau*tau"}, {"D", "v*v/(gamma - gamma)"}}),
              ElementsAre(StartsWith("law.D: is no finite number, expected 0 or more;")));
  // Rounding of a difference near 0 is no negative value.
  EXPECT_THAT(problemsOf({{"msd", "v*v*tau*tau*(exp(1e-17*gamma*tau) - 1)"}}), IsEmpty());
}

TEST(LawProblem, DoesNotAcceptAFormulaBesideAName) {
  EXPECT_THAT(problemsOf({{"name", "rtp"}, {"msd", "v*v*tau*tau"}}),
              ElementsAre(StartsWith("law.msd: found a formula beside the closed form \"rtp\"")));
}

TEST(LawKnowledge, KnowsTheEstimatesOfAProgram) {
  const auto estimates = [](const std::string& name) {
    return lawKnowledge().estimates(shippedProgram(name), kPaperWheelBase);
  };
  EXPECT_THAT(estimates("abp"), ElementsAre("D_r", "v", "D", "L_s", "D_slope"));
  EXPECT_THAT(estimates("rtp"), ElementsAre("v", "gamma", "tau_r", "D", "L_s", "D_slope"));
  EXPECT_THAT(estimates("levy"), ElementsAre("v"));
}

}  // namespace
}  // namespace lab::analysis::law_problem_test
