#include "common/process/event_descriptor.hpp"

#include <sys/eventfd.h>

#include <cerrno>
#include <system_error>

namespace lab {

EventDescriptor::EventDescriptor() : descriptor_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (get() < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

void EventDescriptor::signal() const { static_cast<void>(eventfd_write(get(), 1)); }

void EventDescriptor::clear() const {
  eventfd_t count = 0;
  static_cast<void>(eventfd_read(get(), &count));
}

}  // namespace lab
