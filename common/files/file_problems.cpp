#include "common/files/file_problems.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

namespace lab::keys {
namespace {

bool isInside(std::string_view path, std::string_view around) {
  return path.starts_with(around) &&
         (path.size() == around.size() || path[around.size()] == '.' || path[around.size()] == '[');
}

}  // namespace

void Problems::add(const std::string& path, std::string what) {
  addAt(locate_(path), path, std::move(what));
}

void Problems::addAt(FileLocation place, std::string path, std::string what) {
  problems_.push_back({std::move(place), std::move(path), std::move(what)});
}

bool Problems::concern(const std::string& path) const {
  return std::ranges::any_of(problems_, [&](const Problem& problem) {
    return isInside(problem.path, path) || isInside(path, problem.path);
  });
}

std::vector<std::string> Problems::lines(std::size_t most) const {
  std::vector<Problem> sorted = problems_;
  std::ranges::stable_sort(sorted, {}, [](const Problem& problem) { return problem.place.line; });
  std::vector<std::string> lines;
  for (const Problem& problem : sorted) {
    if (lines.size() == most) {
      lines.push_back("... and " + std::to_string(sorted.size() - most) + " more");
      break;
    }
    lines.push_back(problem.place.text + ": " + problem.path + ": " + problem.what);
  }
  return lines;
}

}  // namespace lab::keys
