#include <avr/eeprom.h>
#include <avr/interrupt.h>
#include <avr/sleep.h>

#include "robot/firmware/avr/adc.hpp"
#include "robot/firmware/avr/clock.hpp"
#include "robot/firmware/avr/motors.hpp"
#include "robot/firmware/avr/restart.hpp"
#include "robot/firmware/avr/uart.hpp"
#include "robot/firmware/device.hpp"

// Referenced by the virtual tables of abstract classes; never called.
extern "C" void __cxa_pure_virtual() {
  for (;;) {
  }
}

namespace lab {
namespace avr {
namespace {

constexpr uint8_t kProMini8MHz = 1;

uint8_t* storeAt(uint16_t address) { return reinterpret_cast<uint8_t*>(address); }

class ProMini final : public firmware::Board {
 public:
  void setMotors(int16_t left, int16_t right) override { avr::setMotors(left, right); }
  bool send(const uint8_t* bytes, uint8_t size) override { return sendBytes(bytes, size); }
  bool lineIdle() const override { return nothingQueued(); }
  uint8_t readStore(uint16_t address) const override { return eeprom_read_byte(storeAt(address)); }
  void writeStore(uint16_t address, uint8_t byte) override {
    eeprom_write_byte(storeAt(address), byte);
  }
  bool storeBusy() const override { return !eeprom_is_ready(); }
  uint16_t stackLeft() const override { return avr::stackLeft(); }
};

firmware::BootFacts bootFacts() {
  firmware::BootFacts facts;
  facts.reset_cause = resetCause();
  facts.board = kProMini8MHz;
  facts.baud = kBaud;
  facts.build = LAB_BUILD;
  return facts;
}

void sleepUntilSomethingHappens(uint32_t last_tick_ms) {
  cli();
  // No interrupt is missed: the instruction after sei() still runs before any interrupt.
  if (bytesWait() || nowMs() != last_tick_ms) {
    sei();
    return;
  }
  sleep_enable();
  sei();
  sleep_cpu();
  sleep_disable();
}

void run(firmware::Device& device) {
  uint32_t last_tick_ms = nowMs();
  for (;;) {
    Received received;
    // At most one full queue, so that a line faster than the program does not block other work.
    for (uint8_t i = 0; i < kReceiveQueue && receiveByte(nowMs(), received); ++i) {
      device.receive(received.ms, received.us, received.byte);
    }
    const uint32_t now_ms = nowMs();
    dynamics::Sensors sensors;
    if (takeScan(sensors)) {
      device.sense(now_ms, sensors);
    }
    if (now_ms != last_tick_ms) {
      last_tick_ms = now_ms;
      device.noteOverrun(takeOverruns());
      device.tick(now_ms);
      if (!scanUnderWay() && device.scanDue(now_ms)) {
        beginScan();
      }
      feedWatchdog();  // only while the clock ticks and this loop runs
    }
    sleepUntilSomethingHappens(last_tick_ms);
  }
}

}  // namespace
}  // namespace avr
}  // namespace lab

int main() {
  using namespace lab;
  avr::startMotors();
  avr::startClock();
  avr::startConverter();
  avr::startUart();
  set_sleep_mode(SLEEP_MODE_IDLE);
  const firmware::BootFacts facts = avr::bootFacts();
  static avr::ProMini board;
  static firmware::Device device(board, facts);
  sei();
  device.boot(avr::nowMs());
  if (facts.reset_cause == wire::kResetWatchdog) {
    device.noteWatchdog(avr::nowMs());
  }
  avr::startWatchdog();
  avr::run(device);
}
