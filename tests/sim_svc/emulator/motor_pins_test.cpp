#include "sim_svc/emulator/motor_pins.hpp"

#include <gtest/gtest.h>

#include <array>

#include "sim_svc/emulator/registers.hpp"

namespace lab::emulator {
namespace {

constexpr unsigned kFastPwm = 3;

/// The registers of a robot that drives left 100 forward and right 200 backward.
struct Registers {
  Registers() {
    data[kDdrB] = 7;
    data[kDdrD] = 0xF4;
    data[kPortB] = 1U << 1U | 1U;  // standby high, BIN2
    data[kPortD] = 1U << 2U;       // AIN1
    data[kTccr0A] = 2U << 6U | 2U << 4U | kFastPwm;
    data[kTccr0B] = 2;
    data[kOcr0B] = 100;
    data[kOcr0A] = 200;
  }
  Duty duty() const { return motorDuty(data.data()); }
  std::array<std::uint8_t, 0x100> data{};
};

TEST(MotorPins, DutyAndDirectionOfEachWheel) {
  Registers registers;
  EXPECT_EQ(registers.duty(), (Duty{100, -200}));
  registers.data[kPortD] = 1U << 4U | 1U << 7U;
  registers.data[kPortB] = 1U << 1U;
  EXPECT_EQ(registers.duty(), (Duty{-100, 200}));
}

TEST(MotorPins, StandbyOrInputPinsStopBothWheels) {
  Registers standby;
  standby.data[kPortB] = 1;
  EXPECT_EQ(standby.duty(), Duty{});
  Registers inputs;
  inputs.data[kDdrB] = 0;
  EXPECT_EQ(inputs.duty(), Duty{});
  Registers no_pwm_pins;
  no_pwm_pins.data[kDdrD] = 1U << 2U;
  EXPECT_EQ(no_pwm_pins.duty(), Duty{});
}

TEST(MotorPins, EqualDirectionPinsDoNotDriveAWheel) {
  Registers brake;
  brake.data[kPortD] = 1U << 2U | 1U << 4U;
  EXPECT_EQ(brake.duty(), (Duty{0, -200}));
  Registers coast;
  coast.data[kPortD] = 0;
  EXPECT_EQ(coast.duty(), (Duty{0, -200}));
}

TEST(MotorPins, WithoutTheTimerThePortControlsThePin) {
  Registers registers;
  registers.data[kTccr0A] = 2U << 6U | kFastPwm;
  EXPECT_EQ(registers.duty(), (Duty{0, -200}));
  registers.data[kPortD] = static_cast<std::uint8_t>(registers.data[kPortD] | 1U << 5U);
  EXPECT_EQ(registers.duty(), (Duty{255, -200}));
}

TEST(MotorPins, AStoppedTimerOrAnotherModeGivesNoPulses) {
  Registers stopped;
  stopped.data[kTccr0B] = 0;
  EXPECT_EQ(stopped.duty(), Duty{});
  Registers ctc;
  ctc.data[kTccr0A] = 2U << 6U | 2U << 4U | 2U;
  EXPECT_EQ(ctc.duty(), Duty{});
}

TEST(MotorPins, Emitters) {
  Registers registers;
  EXPECT_FALSE(emittersOn(registers.data.data()));
  registers.data[kPortB] = 4;
  EXPECT_TRUE(emittersOn(registers.data.data()));
  registers.data[kDdrB] = 3;
  EXPECT_FALSE(emittersOn(registers.data.data()));
}

}  // namespace
}  // namespace lab::emulator
