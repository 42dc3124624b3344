#include "runner/analyze/analyze_commands.hpp"

int main(int argc, char** argv) {
  using namespace lab::runner;
  return commandMain(argc, argv, [](CLI::App& app, Chosen& chosen) {
    addAnalyze(app, chosen);
    addTheory(app, chosen);
    addReportOfRun(app, chosen);
  });
}
