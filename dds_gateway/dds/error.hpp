#pragma once

#include <stdexcept>

namespace lab::dds {

/// DDS cannot do what is asked of it: what, what it said, and the way out.
class DdsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace lab::dds
