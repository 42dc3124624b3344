// Linked into every program of a build with g++ and the undefined-behaviour sanitizer. Beside the
// address sanitizer its runtime ignores log_path (each of both has its own report file), so that a
// report on the stderr of a process would be seen by nobody. Writes it to
// $LAB_UBSAN_REPORTS/ubsan.PID.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

// The monitor interface of the runtime (compiler-rt, lib/ubsan/ubsan_monitor.h).
extern "C" void __ubsan_get_current_report_data(const char** kind, const char** message,
                                                const char** file, unsigned* line, unsigned* column,
                                                char** address);
extern "C" void __ubsan_on_report();

extern "C" void __ubsan_on_report() {
  const char* folder = std::getenv("LAB_UBSAN_REPORTS");
  if (folder == nullptr) return;
  const char* kind = "";
  const char* message = "";
  const char* file = "";
  unsigned line = 0;
  unsigned column = 0;
  char* address = nullptr;
  __ubsan_get_current_report_data(&kind, &message, &file, &line, &column, &address);
  const std::string path = std::string(folder) + "/ubsan." + std::to_string(getpid());
  std::FILE* report = std::fopen(path.c_str(), "a");
  if (report == nullptr) return;
  std::fprintf(report, "%s:%u:%u: %s: %s\n", file, line, column, kind, message);
  std::fclose(report);
}
