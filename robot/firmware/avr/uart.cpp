#include "robot/firmware/avr/uart.hpp"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

#include "robot/firmware/avr/clock.hpp"

// The divider for double speed mode, rounded to nearest, and the resulting speed.
#define LAB_UBRR ((F_CPU + 4UL * LAB_BAUD) / (8UL * LAB_BAUD) - 1UL)
#define LAB_REAL_BAUD (F_CPU / (8UL * (LAB_UBRR + 1UL)))
#if LAB_REAL_BAUD * 1000UL > LAB_BAUD * 1015UL || LAB_REAL_BAUD * 1000UL < LAB_BAUD * 985UL
#error "LAB_BAUD cannot be made from the clock within 1.5 %; 38400 and 500000 can at 8 MHz"
#endif

namespace lab {
namespace avr {
namespace {

constexpr uint8_t kTxSize = 128;  ///< also a power of two

uint8_t rx[kReceiveQueue];
volatile uint8_t rx_in = 0;   ///< written by the interrupt
volatile uint8_t rx_out = 0;  ///< written by the program

uint8_t tx[kTxSize];
volatile uint8_t tx_in = 0;   ///< written by the program
volatile uint8_t tx_out = 0;  ///< written by the interrupt

volatile uint16_t overruns = 0;
volatile Instant last_zero = {0, 0};  ///< when the last 0 was received

uint8_t next(uint8_t index, uint8_t size) {
  return static_cast<uint8_t>((index + 1U) & (size - 1U));
}

}  // namespace

void startUart() {
  UCSR0B = 0;
  rx_in = rx_out = tx_in = tx_out = 0;
  overruns = 0;
  // Double speed mode must be set before the divider.
  UCSR0A = 1U << U2X0;
  UCSR0C = 1U << UCSZ01 | 1U << UCSZ00;
  UBRR0H = static_cast<uint8_t>(LAB_UBRR >> 8);
  UBRR0L = static_cast<uint8_t>(LAB_UBRR & 0xFFU);
  UCSR0B = 1U << RXCIE0 | 1U << RXEN0 | 1U << TXEN0;
}

bool receiveByte(uint32_t now_ms, Received& received) {
  const uint8_t out = rx_out;
  if (out == rx_in) {
    return false;
  }
  received.byte = rx[out];
  rx_out = next(out, kReceiveQueue);
  received.ms = now_ms;
  received.us = 0;
  if (received.byte == 0) {
    uint16_t ms;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
      ms = last_zero.ms;
      received.us = last_zero.us;
    }
    received.ms = now_ms - static_cast<uint16_t>(static_cast<uint16_t>(now_ms) - ms);
  }
  return true;
}

bool bytesWait() { return rx_in != rx_out; }

bool sendBytes(const uint8_t* bytes, uint8_t size) {
  uint8_t in = tx_in;
  const uint8_t used = static_cast<uint8_t>((in - tx_out) & (kTxSize - 1U));
  if (size > kTxSize - 1U - used) {
    return false;
  }
  for (uint8_t i = 0; i < size; ++i) {
    tx[in] = bytes[i];
    in = next(in, kTxSize);
  }
  tx_in = in;
  UCSR0B = 1U << RXCIE0 | 1U << UDRIE0 | 1U << RXEN0 | 1U << TXEN0;
  return true;
}

bool nothingQueued() { return tx_in == tx_out; }

uint16_t takeOverruns() {
  uint16_t count;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    count = overruns;
    overruns = 0;
  }
  return count;
}

}  // namespace avr
}  // namespace lab

ISR(USART_RX_vect) {
  using namespace lab::avr;
  const uint8_t status = UCSR0A;  // must be read before the byte
  const uint8_t byte = UDR0;
  if ((status & 1U << DOR0) != 0) {
    overruns = overruns + 1;
  }
  const uint8_t in = rx_in;
  const uint8_t after = next(in, kReceiveQueue);
  if (after == rx_out) {
    overruns = overruns + 1;
    return;
  }
  rx[in] = byte;
  rx_in = after;
  if (byte == 0) {
    const Instant now = nowWithInterruptsOff();
    last_zero.ms = now.ms;
    last_zero.us = now.us;
  }
}

ISR(USART_UDRE_vect) {
  using namespace lab::avr;
  const uint8_t out = tx_out;
  if (out == tx_in) {
    UCSR0B = 1U << RXCIE0 | 1U << RXEN0 | 1U << TXEN0;
    return;
  }
  UDR0 = tx[out];
  tx_out = next(out, kTxSize);
}
