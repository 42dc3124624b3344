#include "robot/firmware/avr/adc.hpp"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "robot/firmware/avr/pins.hpp"

namespace lab {
namespace avr {
namespace {

using dynamics::kIrSensors;

// Order of the conversions in a scan: two light sensors and six infrared sensors with the emitters
// off, one unused conversion while the emitters settle, six infrared sensors with the emitters on.
constexpr uint8_t kDark = 2;
constexpr uint8_t kSettle = kDark + kIrSensors;
constexpr uint8_t kLit = kSettle + 1;
constexpr uint8_t kEnd = kLit + kIrSensors;

volatile uint8_t step = kEnd;
volatile bool complete = false;
uint16_t light_front, light_back;
uint16_t dark[kIrSensors];
uint16_t lit[kIrSensors];

uint8_t channelOf(uint8_t at) {
  if (at >= kLit) {
    return static_cast<uint8_t>(at - kLit);
  }
  if (at == kSettle) {
    return 0;
  }
  if (at >= kDark) {
    return static_cast<uint8_t>(at - kDark);
  }
  return at == 0 ? kFrontLightChannel : kBackLightChannel;
}

void convert(uint8_t at) {
  ADMUX = static_cast<uint8_t>(1U << REFS0 | channelOf(at));
  ADCSRA = 1U << ADEN | 1U << ADSC | 1U << ADIF | 1U << ADIE | 1U << ADPS2 | 1U << ADPS1;
}

}  // namespace

void startConverter() {
  ADCSRA = 0;
  DIDR0 = 0x3F;  // disable the digital inputs of A0 to A5
  PORTB = static_cast<uint8_t>(PORTB & ~kIrEmitters);
  DDRB = static_cast<uint8_t>(DDRB | kIrEmitters);
  step = kEnd;
  complete = false;
}

void beginScan() {
  step = 0;
  convert(0);
}

// Includes a complete scan that was not fetched yet. Otherwise the program could begin another scan
// before it fetches this one, and would then be one period late.
bool scanUnderWay() { return step != kEnd || complete; }

bool takeScan(dynamics::Sensors& sensors) {
  if (!complete) {
    return false;
  }
  complete = false;
  sensors.light_front = light_front;
  sensors.light_back = light_back;
  for (uint8_t i = 0; i < kIrSensors; ++i) {
    sensors.ir[i] = lit[i] > dark[i] ? static_cast<uint16_t>(lit[i] - dark[i]) : 0;
  }
  return true;
}

}  // namespace avr
}  // namespace lab

ISR(ADC_vect) {
  using namespace lab::avr;
  // Read the result of the present channel before the channel is changed.
  const uint16_t counts = ADC;
  const uint8_t at = step;
  if (at >= kLit) {
    lit[at - kLit] = counts;
  } else if (at == 0) {
    light_front = counts;
  } else if (at < kDark) {
    light_back = counts;
  } else if (at < kSettle) {
    dark[at - kDark] = counts;
  }
  const uint8_t next = static_cast<uint8_t>(at + 1);
  step = next;
  if (next == kEnd) {
    PORTB = static_cast<uint8_t>(PORTB & ~kIrEmitters);
    complete = true;
    return;
  }
  if (next == kSettle) {
    PORTB = static_cast<uint8_t>(PORTB | kIrEmitters);
  }
  convert(next);
}
