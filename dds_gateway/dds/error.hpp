#pragma once

#include <stdexcept>

namespace lab::dds {

/// An operation of DDS failed. The text says which, the reason given by DDS, and how to fix it.
class DdsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace lab::dds
