/// The files of the page, which are compiled into the program.
#pragma once

#include <string_view>
#include <vector>

namespace lab::dashboard {

struct PageFile {
  std::string_view name;     ///< "index.html"
  std::string_view content;  ///< bytes of the file at build time
};

/// All files of dashboard/page/, D3 and its licence.
[[nodiscard]] const std::vector<PageFile>& pageFiles();

}  // namespace lab::dashboard
