// The main program of a test group: runs the tests of the source files named as arguments, or all.
#include <gtest/gtest.h>

#include <filesystem>
#include <iostream>
#include <map>
#include <string>

namespace {

// The --gtest_filter of the tests in each source file.
std::map<std::string, std::string> filtersBySource() {
  std::map<std::string, std::string> filters;
  const auto& all = *testing::UnitTest::GetInstance();
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const auto& suite = *all.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const auto& test = *suite.GetTestInfo(t);
      filters[std::filesystem::path(test.file()).filename()] +=
          std::string(suite.name()) + '.' + test.name() + ':';
    }
  }
  return filters;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const auto filters = filtersBySource();
  std::string selected;
  for (int i = 1; i < argc; ++i) {
    const auto found = filters.find(std::filesystem::path(argv[i]).filename());
    if (found == filters.end()) {
      std::cerr << argv[0] << ": no tests of " << argv[i] << "; this program has the tests of";
      for (const auto& [source, filter] : filters) std::cerr << ' ' << source;
      std::cerr << '\n';
      return 2;
    }
    selected += found->second;
  }
  if (!selected.empty()) GTEST_FLAG_SET(filter, selected);
  return RUN_ALL_TESTS();
}
