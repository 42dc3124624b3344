#include "common/loop/descriptor_watcher.hpp"

namespace lab {
namespace {

class NoDescriptors final : public Descriptors {
 public:
  std::unique_ptr<Watch> watch(int /*descriptor*/, std::function<void()> /*callback*/) override {
    throw std::logic_error("no file descriptor can be watched in virtual time");
  }
};

}  // namespace

Descriptors& noDescriptors() {
  static NoDescriptors none;
  return none;
}

}  // namespace lab
