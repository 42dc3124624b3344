#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/camera/camera_source.hpp"
#include "common/experiment/command_line_sources.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/keys/experiment_form.hpp"
#include "common/experiment/keys/experiment_keys.hpp"
#include "common/files/file_values.hpp"
#include "common/programs/program_file.hpp"

namespace lab {
namespace keys {
namespace {

class TomlWriter final : public KeyVisitor {
 public:
  void number(const Key& key, const Range&, double& si) override {
    write(key, fileText(si, unitOf(key.name)));
  }
  void optionalNumber(const Key& key, const Range&, std::optional<double>& si) override {
    if (si) write(key, fileText(*si, unitOf(key.name)));
  }
  void integer(const Key& key, std::int64_t, std::int64_t, std::int64_t& value) override {
    write(key, std::to_string(value));
  }
  void flag(const Key& key, bool& value) override { write(key, value ? "true" : "false"); }
  void text(const Key& key, const TextRule&, std::string& value) override {
    write(key, tomlString(value));
  }
  void choice(const Key& key, std::span<const Choice> choices, int& value) override {
    const auto chosen = std::ranges::find(choices, value, &Choice::value);
    write(key, tomlString(chosen == choices.end() ? std::to_string(value) : chosen->name));
  }
  void interval(const Key& key, const Range&, double& low, double& high) override {
    const FileUnit& unit = unitOf(key.name);
    write(key, '[' + fileText(low, unit) + ", " + fileText(high, unit) + "]");
  }

  void integers(const Key& key, std::int64_t, std::int64_t, const ListRule&,
                std::vector<std::int32_t>& values) override {
    writeAll(key, values, [](std::int32_t value) { return std::to_string(value); });
  }
  void texts(const Key& key, const TextRule&, const ListRule&,
             std::vector<std::string>& values) override {
    writeAll(key, values, [](const std::string& value) { return tomlString(value); });
  }

  void table(const Key& key, const std::function<void()>& keys) override {
    if (key.need == Need::kShorthand) return;
    block("[" + path_ + key.name + "]", path_ + key.name + ".", keys);
  }
  void inLineTable(const Key& key, bool& given, const std::function<void()>& keys) override {
    if (!given) return;
    const bool within = std::exchange(in_line_, true);  // an element of a list in one line
    text_ += (within && !first_ ? ", " : "") + key.name + " = {";
    first_ = true;
    keys();
    in_line_ = within;
    first_ = false;
    text_ += within ? "}" : "}\n";
  }
  void list(const Key& key, const ListRule& rule, std::size_t size,
            const std::function<void(std::size_t)>&,
            const std::function<void(std::size_t)>& element) override {
    if (rule.in_line) {
      writeInLine(key, size, element);
      return;
    }
    const std::string path = path_ + key.name;
    for (std::size_t i = 0; i < size; ++i) {
      block("[[" + path + "]]", path + ".", [&] { element(i); });
    }
  }
  void namedTables(const Key& key, const TextRule&, const ListRule&,
                   const std::vector<std::string>& names,
                   const std::function<void(const std::string&)>& keys) override {
    for (const std::string& name : names) {
      const std::string path = path_ + key.name + "." + name;
      block("[" + path + "]", path + ".", [&] { keys(name); });
    }
  }

  void program(const std::string& name, const dynamics::WheelLimits&, Program& program) override {
    const auto document = readProgram(program.text, "programs." + name, name, kWidestWheels);
    text_ += programToml(document.text, path_);
  }

  [[nodiscard]] const std::string& result() const { return text_; }

 private:
  void write(const Key& key, const std::string& value) {
    if (key.applies != Applies::kYes || key.need == Need::kShorthand) return;
    if (in_line_) {
      text_ += (first_ ? "" : ", ") + key.name + " = " + value;
      first_ = false;
    } else {
      text_ += key.name + " = " + value + "\n";
    }
  }

  template <typename Element, typename ToText>
  void writeAll(const Key& key, const std::vector<Element>& values, const ToText& to_text) {
    std::string text;
    for (const Element& value : values) text += (text.empty() ? "" : ", ") + to_text(value);
    write(key, "[" + text + "]");
  }

  void writeInLine(const Key& key, std::size_t size,
                   const std::function<void(std::size_t)>& element) {
    text_ += key.name + " = [\n";
    in_line_ = true;
    for (std::size_t i = 0; i < size; ++i) {
      text_ += "  {";
      first_ = true;
      element(i);
      text_ += "},\n";
    }
    in_line_ = false;
    text_ += "]\n";
  }

  template <typename Keys>
  void block(const std::string& header, const std::string& path, const Keys& keys) {
    text_ += "\n" + header + "\n";
    const std::string outer = path_;
    path_ = path;
    keys();
    path_ = outer;
  }

  std::string text_;
  std::string path_;  ///< "light." before the keys of this block
  bool in_line_ = false;
  bool first_ = true;
};

}  // namespace
}  // namespace keys

std::string writeExperiment(const Experiment& experiment) {
  keys::ExperimentForm form = keys::toForm(experiment);
  // What only a command line may name does not come back from a file (docs/security.md).
  form.common.gateway.configuration.clear();
  if (!pipelineOf(form.common.camera).empty()) form.common.camera.source = kPipelineCamera;
  keys::TomlWriter writer;
  keys::visitKeys(writer, form);
  return writer.result();
}

}  // namespace lab
