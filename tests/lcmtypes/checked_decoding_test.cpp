// The check of encodings that cmake/CheckedDecoding.cmake makes from a definition: it is complete,
// or the build ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string>

#include "lcmtypes/encoding_checker.hpp"
#include "tests/lcmtypes/contract.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::checked_decoding_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path kRoot = LAB_SOURCE_FOLDER;

std::string contentsOf(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The script's run on a definition, as the build does it.
class Script {
 public:
  explicit Script(const std::string& definition) {
    std::ofstream(definition_) << definition;
    // lcm-gen's class may have any text, and the header may be there from the build before.
    std::ofstream(folder_ / "class.hpp") << "not C++ of any version";
    std::ofstream(header_) << "old";
    const std::string command = LAB_CMAKE " -DTYPE=" + definition_.string() +
                                " -DCLASS=class.hpp -DHEADER=" + header_.string() + " -P " +
                                (kRoot / "cmake/CheckedDecoding.cmake").string() + " 2>&1";
    FILE* const pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error("cannot run " + command);
    std::array<char, 4096> buffer{};
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
      output_.append(buffer.data(), n);
    }
    const int status = pclose(pipe);
    exit_status_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  [[nodiscard]] int exitStatus() const { return exit_status_; }
  [[nodiscard]] const std::string& output() const { return output_; }
  [[nodiscard]] bool wroteHeader() const { return fs::exists(header_); }
  [[nodiscard]] std::string header() const { return contentsOf(header_); }
  [[nodiscard]] std::string definition() const { return definition_.string(); }

 private:
  TemporaryFolder folder_;
  fs::path definition_ = folder_ / "sample_t.lcm";
  fs::path header_ = folder_ / "sample_t.hpp";
  std::string output_;
  int exit_status_ = -1;
};

TEST(CheckedDecoding, ChecksEveryFieldOfADefinition) {
  const Script script(R"(package other;

// A comment; with int32_t signs[num_signs];
struct sample_t {
  int64_t utime;   // [us] a unit; more
  string sender;
  const int8_t ON = 1, OFF = 0;
  boolean on; byte raw; int8_t a; int16_t b; float c; double d;
  double covariance[6];
  string names [ 3 ] ;
  part_t part;
  int16_t num_parts;
  part_t parts[num_parts];
  string words[num_parts];
  byte grid[num_parts];
}
)");

  ASSERT_EQ(script.exitStatus(), 0) << script.output();
  EXPECT_EQ(script.header(),
            R"(// Made by cmake/CheckedDecoding.cmake from the definition of sample_t.
#pragma once
#include "class.hpp"
#include "lcmtypes/encoding_checker.hpp"

namespace other {

inline void checkFields(lab::EncodingChecker& packet, const sample_t* /*type*/) {
  packet.numbers(8, 1);  // utime
  packet.strings(1);  // sender
  packet.numbers(1, 1);  // on
  packet.numbers(1, 1);  // raw
  packet.numbers(1, 1);  // a
  packet.numbers(2, 1);  // b
  packet.numbers(4, 1);  // c
  packet.numbers(8, 1);  // d
  packet.numbers(8, 6);  // covariance
  packet.strings(3);  // names
  packet.structs<part_t>(1);  // part
  const std::int64_t num_parts = packet.count<int16_t>();
  packet.structs<part_t>(num_parts);  // parts
  packet.strings(num_parts);  // words
  packet.numbers(1, num_parts);  // grid
}

}  // namespace other
)");
}

class DefinitionRefused : public testing::TestWithParam<std::string> {};

TEST_P(DefinitionRefused, EndsTheBuildWithOneLineAndNoHeader) {
  const std::string statement = GetParam();

  const Script script("package lab;\nstruct sample_t {\n  int32_t n;\n  " + statement + "\n}\n");

  EXPECT_NE(script.exitStatus(), 0);
  EXPECT_FALSE(script.wroteHeader());
  EXPECT_THAT(script.output(), HasSubstr("\n   " + script.definition() + ": found \"" + statement +
                                         "\", expected \"TYPE NAME;\" or "));
  EXPECT_THAT(script.output(), testing::ContainsRegex("; write it so, or extend [^\n]*\n"));
}

INSTANTIATE_TEST_SUITE_P(Statements, DefinitionRefused,
                         testing::Values("double pose[n][3];", "double x, y;", "int8_t flags[0];",
                                         "int8_t flags[010];", "int8_t flags[];",
                                         "sample_t children[n];", "other.part_t part;",
                                         "/* old */ int8_t a;", "int8_t a",
                                         "} struct second_t { int8_t a;"));

TEST(CheckedDecoding, NeedsOneStructOfAPackage) {
  for (const std::string text : {"", "struct sample_t { int8_t a; }", "package lab;"}) {
    const Script script(text);
    EXPECT_NE(script.exitStatus(), 0) << text;
    EXPECT_FALSE(script.wroteHeader()) << text;
    EXPECT_THAT(script.output(), HasSubstr("expected one \"package NAME; struct NAME"));
  }
}

struct UncheckedMessage {};

TEST(CheckedDecoding, IsNeededToCompileADecode) {
  EXPECT_TRUE(CheckedMessage<light_drive_t>);
  EXPECT_FALSE(CheckedMessage<UncheckedMessage>);
}

// LCM's own decode() checks nothing: common/bus/codec.hpp is the one that may call it.
TEST(CheckedDecoding, IsNotBypassed) {
  const std::string call = "decode(";
  std::set<std::string> callers;
  for (const auto& folder : fs::directory_iterator(kRoot)) {
    const std::string name = folder.path().filename();
    if (!folder.is_directory() || name.starts_with(".") || name == "build") continue;
    for (const auto& file : fs::recursive_directory_iterator(folder)) {
      const fs::path extension = file.path().extension();
      if (extension != ".cpp" && extension != ".hpp") continue;
      const std::string text = contentsOf(file);
      for (const std::string& use : {"." + call, "->" + call}) {
        if (text.find(use) != std::string::npos) callers.insert(file.path().filename());
      }
    }
  }
  EXPECT_THAT(callers, testing::ElementsAre("codec.hpp"));
}

}  // namespace
}  // namespace lab::checked_decoding_test
