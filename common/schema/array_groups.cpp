#include "common/schema/array_groups.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace lab::schema {
namespace {

void addPaths(const Type& type, const std::string& above, const std::string& prefix,
              std::vector<std::string>& paths) {
  for (const ArrayGroup& group : arrayGroups(type)) {
    const std::string path = above + prefix + group.name;
    paths.push_back(path);
    for (const int index : group.fields) {
      const Field& field = type.fields[static_cast<std::size_t>(index)];
      if (field.type != nullptr) addPaths(*field.type, path + ".", "", paths);
    }
  }
  for (const Field& field : type.fields) {
    if (field.type != nullptr && !field.array) {
      addPaths(*field.type, above, prefix + field.name + "_", paths);
    }
  }
}

}  // namespace

std::vector<ArrayGroup> arrayGroups(const Type& type) {
  constexpr std::string_view kCount = "num_";
  std::vector<ArrayGroup> groups;
  for (std::size_t i = 0; i < type.fields.size(); ++i) {
    const int count = type.fields[i].count_field;
    if (count < 0) continue;
    auto group = std::ranges::find(groups, count, &ArrayGroup::count_field);
    if (group == groups.end()) {
      groups.push_back({type.fields[i].name, {}, count});
      group = groups.end() - 1;
    }
    group->fields.push_back(static_cast<int>(i));
    if (group->fields.size() < 2) continue;
    const std::string& name = type.fields[static_cast<std::size_t>(count)].name;
    group->name = name.starts_with(kCount) ? name.substr(kCount.size()) : name;
  }
  return groups;
}

std::vector<std::string> tablePaths(const Type& type) {
  std::vector<std::string> paths{""};
  addPaths(type, "", "", paths);
  return paths;
}

}  // namespace lab::schema
