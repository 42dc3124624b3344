#include "common/loop/descriptor_watcher.hpp"

namespace lab {
namespace {

class NoDescriptorWatcher final : public DescriptorWatcher {
 public:
  std::unique_ptr<Watch> watch(int /*descriptor*/, std::function<void()> /*callback*/) override {
    throw std::logic_error("no file descriptor can be watched in virtual time");
  }
};

}  // namespace

DescriptorWatcher& noDescriptorWatcher() {
  static NoDescriptorWatcher none;
  return none;
}

}  // namespace lab
