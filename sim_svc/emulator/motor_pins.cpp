#include "sim_svc/emulator/motor_pins.hpp"

#include "sim_svc/emulator/registers.hpp"

namespace lab::emulator {
namespace {

constexpr unsigned kStandby = 1U << 1U;   // PB1, D9
constexpr unsigned kEmitters = 1U << 2U;  // PB2, D10
constexpr unsigned kRight2 = 1U << 0U;    // PB0, D8: BIN2
constexpr unsigned kRight1 = 1U << 7U;    // PD7, D7: BIN1
constexpr unsigned kRightPwm = 1U << 6U;  // PD6, D6: PWMB, OC0A
constexpr unsigned kLeftPwm = 1U << 5U;   // PD5, D5: PWMA, OC0B
constexpr unsigned kLeft2 = 1U << 4U;     // PD4, D4: AIN2
constexpr unsigned kLeft1 = 1U << 2U;     // PD2, D2: AIN1

/// The duty of a PWM pin, 0..255.
int width(unsigned connection, std::uint8_t compare, const std::uint8_t* data, bool port_high) {
  if (connection == 0) {
    return port_high ? 255 : 0;
  }
  const bool fast_pwm = (data[kTccr0A] & 3U) == 3U && (data[kTccr0B] & 8U) == 0;
  const bool clocked = (data[kTccr0B] & 7U) != 0;
  if (!fast_pwm || !clocked || connection == 1) {
    return 0;
  }
  return connection == 2 ? compare : 255 - compare;
}

std::int16_t wheel(int pwm, bool in1, bool in2) {
  if (in1 == in2) {
    return 0;
  }
  return static_cast<std::int16_t>(in1 ? pwm : -pwm);
}

}  // namespace

Duty motorDuty(const std::uint8_t* data) {
  const unsigned b = data[kPortB] & data[kDdrB];
  const unsigned d = data[kPortD] & data[kDdrD];
  if ((b & kStandby) == 0) {
    return {};
  }
  const bool left_output = (data[kDdrD] & kLeftPwm) != 0;
  const bool right_output = (data[kDdrD] & kRightPwm) != 0;
  const unsigned control = data[kTccr0A];
  const int left =
      left_output ? width((control >> 4U) & 3U, data[kOcr0B], data, (d & kLeftPwm) != 0) : 0;
  const int right =
      right_output ? width((control >> 6U) & 3U, data[kOcr0A], data, (d & kRightPwm) != 0) : 0;
  return {wheel(left, (d & kLeft1) != 0, (d & kLeft2) != 0),
          wheel(right, (d & kRight1) != 0, (b & kRight2) != 0)};
}

bool emittersOn(const std::uint8_t* data) { return (data[kPortB] & data[kDdrB] & kEmitters) != 0; }

}  // namespace lab::emulator
