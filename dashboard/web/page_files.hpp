/// The page's own files, which the program carries inside.
#pragma once

#include <string_view>
#include <vector>

namespace lab::dashboard {

struct PageFile {
  std::string_view name;     ///< "index.html"
  std::string_view content;  ///< as on disk when the program was built
};

/// All of dashboard/page/, D3 and the licences.
[[nodiscard]] const std::vector<PageFile>& pageFiles();

}  // namespace lab::dashboard
