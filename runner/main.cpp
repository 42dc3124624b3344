#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <iostream>

#include "analyzer/report_error.hpp"
#include "common/bus/bus_error.hpp"
#include "common/experiment/experiment_file.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/commands/command_line.hpp"

int main(int argc, char** argv) {
  using namespace lab::runner;
  spdlog::set_default_logger(spdlog::stderr_color_mt("lab"));
  std::signal(SIGPIPE, SIG_IGN);  // whoever read our output may go; the run goes on
  spdlog::set_pattern("%^%l%$: %v");
  try {
    return runCommandLine(argc, argv);
  } catch (const lab::ExperimentError& error) {
    std::cerr << error.what() << "\n";
    return kBadInput;
  } catch (const UserError& error) {
    std::cerr << "lab: " << error.what() << "\n";
    return kBadInput;
  } catch (const lab::report::ReportError& error) {
    std::cerr << "lab: " << error.what() << "\n";
    return kBadInput;
  } catch (const lab::BusError& error) {
    std::cerr << "lab: " << error.what() << "\n";
    return kBadInput;
  } catch (const std::exception& error) {
    std::cerr << "lab: " << error.what() << "\n";
    return kFailed;
  }
}
