/* A program for the tests of the simulated chip: executes one action per received letter. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>
#include <stdint.h>

static volatile uint8_t ticking = 0;

static void put(uint8_t byte) {
  while ((UCSR0A & 1 << UDRE0) == 0) {
  }
  UDR0 = byte;
}

static uint8_t get(void) {
  while ((UCSR0A & 1 << RXC0) == 0) {
    wdt_reset();
  }
  return UDR0;
}

/* Sends the number of received bytes and whether one was lost. */
static void countBytes(void) {
  uint16_t count = 0;
  uint8_t lost = 0;
  for (;;) {
    wdt_reset();
    if ((UCSR0A & 1 << RXC0) != 0) {
      lost |= UCSR0A & (1 << DOR0 | 1 << FE0);
      if (UDR0 == 'E') break;
      ++count;
    }
  }
  put((uint8_t)count);
  put((uint8_t)(count >> 8));
  put(lost);
}

static void waitMs(uint16_t ms) {
  while (ms-- > 0) {
    TCNT1 = 0;
    while (TCNT1 < 8000) wdt_reset();
  }
}

/* Moves the stack pointer from 0x0805 to 0x07FB as avr-gcc does, the high byte first. */
static void makeRoom(void) {
  const uint8_t low = SPL;
  sei();
  SPL = 0x05;
  SPH = 0x07;
  SPL = 0xFB;
  SPH = 0x08;
  SPL = low;
  cli();
}

static void pwm(void) {
  DDRB |= 7;
  DDRD |= 0xF4;
  TCCR0A = 1 << COM0A1 | 1 << COM0B1 | 3;
  TCCR0B = 2;
  PORTB |= 2;
  PORTD |= 1 << 2; /* left forward */
  OCR0B = 100;
  PORTB |= 1; /* right backward */
  OCR0A = 200;
}

int main(void) {
  const uint8_t cause = MCUSR;
  MCUSR = 0;
  wdt_disable();
  UCSR0A = 1 << U2X0;
  UCSR0C = 1 << UCSZ01 | 1 << UCSZ00;
  UBRR0 = 25;
  UCSR0B = 1 << RXEN0 | 1 << TXEN0;
  TCCR1B = 1;
  put('!');
  put(cause);
  for (;;) {
    switch (get()) {
      case 't': /* sends a hundred bytes at full speed */
        for (uint8_t i = 0; i < 100; ++i) put(i);
        break;
      case 'c':
        countBytes();
        break;
      case 'd': /* does not read its receiver for 20 ms */
        waitMs(20);
        put('d');
        break;
      case 'w': /* the watchdog resets in 16 ms */
        DDRB |= 7;
        PORTB |= 2;
        wdt_enable(WDTO_15MS);
        for (;;) {
        }
      case 'm':
        makeRoom();
        put('m');
        break;
      case 'p':
        pwm();
        put('p');
        break;
      case 's': /* sleeps with interrupts off */
        cli();
        sleep_enable();
        sleep_cpu();
        break;
      case 'i': /* sleeps, with a timer that wakes it every ms */
        OCR1A = 7999;
        TCCR1B = 1 << WGM12 | 1;
        TIMSK1 = 1 << OCIE1A;
        DDRD |= 1 << 2 | 1 << 3;
        PORTD &= (uint8_t) ~(1 << 2 | 1 << 3); /* low, with interrupts 0 and 1 unused */
        sei();
        for (;;) {
          sleep_enable();
          sleep_cpu();
        }
      case 'b': /* sleeps, and sends a byte every ms */
        OCR1A = 7999;
        TCCR1B = 1 << WGM12 | 1;
        TIMSK1 = 1 << OCIE1A;
        ticking = 1;
        sei();
        for (;;) {
          sleep_enable();
          sleep_cpu();
        }
      case 'e': /* writes two bytes into the EEPROM and reports when it is ready */
        for (uint8_t i = 0; i < 2; ++i) {
          while ((EECR & 1 << EEPE) != 0) {
          }
          EEAR = 100 + i;
          EEDR = 0x55 + i;
          EECR |= 1 << EEMPE;
          EECR |= 1 << EEPE;
        }
        while ((EECR & 1 << EEPE) != 0) {
        }
        put('e');
        break;
      default:
        put('?');
    }
  }
}

ISR(TIMER1_COMPA_vect) {
  if (ticking) UDR0 = 'b';
}
