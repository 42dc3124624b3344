#include "robot_bridge/protocol/desired_state.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/math/units.hpp"
#include "robot/wire/config.hpp"

namespace lab::bridge {
namespace {

constexpr std::size_t kTablesKept = 4;

std::int32_t micrometres(double metres) {
  return static_cast<std::int32_t>(std::lround(metres * 1e6));
}

}  // namespace

bool DesiredState::command(const CommandKey& key, std::int32_t lease_ms, const robot_order_t& order,
                           std::int64_t now) {
  lease_end_ = now + std::int64_t{std::max(0, lease_ms)} * units::kMillisecond_us;
  if (key == received_) return false;
  received_ = key;
  unconverted_ = orderToKeep(order, robot_id_);
  return true;
}

std::string DesiredState::convert(double wheel_base) {
  if (!unconverted_) return {};
  const robot_order_t order = *std::exchange(unconverted_, std::nullopt);
  OrderSettings settings = settingsFrom(order, {max_wheel_speed_, wheel_base}, sensor_period_);
  rejected_ = !settings.refusal.empty();
  if (rejected_) return settings.refusal;
  standing_ = false;
  refused_ = false;
  has_order_ = true;
  active_ = received_;
  mode_ = order.mode;
  order_id_ = static_cast<std::uint8_t>(order_id_ % 255 + 1);
  if (mode_ == robot_order_t::DRIVE) {
    wheel_left_ = order.wheel_left;
    wheel_right_ = order.wheel_right;
  }
  // DRIVE works with any settings, but the robot must have some.
  const bool keeps_settings = mode_ != robot_order_t::TABLE && config_ != 0;
  if (!keeps_settings) {
    wanted_ = std::move(settings);
    wanted_.core.robot_id = static_cast<std::uint16_t>(robot_id_);
    config_ = wire::configCrc(wanted_.core);
    rememberPrograms();
  }
  return {};
}

void DesiredState::rememberPrograms() {
  std::erase_if(tables_, [this](const ProgramTable& table) { return table.config == config_; });
  std::vector<program_id_t> programs;
  for (const program_t& program : wanted_.programs) programs.push_back(program.id);
  tables_.push_back({config_, std::move(programs)});
  if (tables_.size() > kTablesKept) tables_.pop_front();
}

const program_t* DesiredState::definition(std::uint32_t hash) const {
  const auto found = std::find_if(
      wanted_.programs.begin(), wanted_.programs.end(),
      [hash](const program_t& program) { return program.id.hash == std::int64_t{hash}; });
  return found == wanted_.programs.end() ? nullptr : &*found;
}

program_id_t DesiredState::programOf(std::uint16_t config, std::uint8_t slot) const {
  for (const ProgramTable& table : tables_) {
    if (table.config == config && slot < table.programs.size()) return table.programs[slot];
  }
  return {};
}

wire::Order DesiredState::orderMessage(std::uint16_t config, std::int64_t now) const {
  wire::Order order;
  order.config = config;
  order.lease_ms = leaseLeft_ms(now);
  order.id = standing_ ? 0 : order_id_;
  if (!standing_ && mode_ == robot_order_t::TABLE) order.mode = wire::Order::kTable;
  if (!standing_ && mode_ == robot_order_t::DRIVE) {
    order.mode = wire::Order::kDrive;
    order.left_um_s = micrometres(wheel_left_);
    order.right_um_s = micrometres(wheel_right_);
  }
  return order;
}

std::uint32_t DesiredState::leaseLeft_ms(std::int64_t now) const {
  return static_cast<std::uint32_t>(std::max<std::int64_t>(0, lease_end_ - now) /
                                    units::kMillisecond_us);
}

}  // namespace lab::bridge
