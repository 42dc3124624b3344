#include "dds_gateway/topic_mapping_file.hpp"

#include "common/files/file_text.hpp"
#include "dds_gateway/ros/topic_mapping.hpp"

namespace lab::gateway {

std::string topicMappingText(const std::filesystem::path& file) {
  std::string text = readFileText(file, file_kinds::kMapping);
  static_cast<void>(TopicMapping(text, file.string()));
  return text;
}

}  // namespace lab::gateway
