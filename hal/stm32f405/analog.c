/* Analogue inputs by the first converter (RM0090 chapter 13): each millisecond the board clock starts a scan of all of them and of the chip's own
 * reference; an interrupt for each conversion adds it to the mean. No DMA, so that where the memory lies does not matter. A conversion takes 23 us
 * at 168 MHz, nearly all of it for the input to settle, so that sources of 50 kohm are right.
 *
 * The converter stops when an interrupt was held off for longer than that, as in an erase of the flash; the next scan begins anew.
 *
 * The reference: DS8626 has its value at 3.3 V at 0x1FFF7A2A (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "hal/analog.h"

#include <stddef.h>

#include "board.h"
#include "io_interrupts.h"
#include "pin_map.h"
#include "registers.h"

#define INPUTS_MOST   8u
#define CHANNEL_REF   17u
#define MEAN          16u /* conversions */
#define LONGEST       7u  /* code of the sampling time: 480 cycles */
#define ALL_LONGEST   0x3FFFFFFFu
#define ALL_LONGEST_1 0x07FFFFFFu /* nine channels */
#define FAST_BUS_HZ                                                                                \
    60000000u /* above it, half of the bus's clock is more than the 30 MHz that are allowed */
#define FACTORY_V  3.3f
#define FIRST_WORD 6u /* channels in each of the registers of the sequence */

/* Input 0 is the reference. */
static struct analog_input {
    uint32_t sum;             /* of `last` */
    volatile uint32_t meaned; /* the sum, once it is of 16 conversions; plus 1: 0 is none yet */
    uint16_t last[MEAN];
    hal_pin pin;
    uint8_t channel, next, n; /* n: conversions so far, at most 16 */
} inputs[1u + INPUTS_MOST];

static struct analog_run {
    volatile uint8_t n;     /* inputs */
    uint8_t scanned, going; /* going: the inputs of the scan under way */
    volatile bool runs;
} run;

static uint32_t channel_of(hal_pin pin)
{
    uint32_t number = PIN_NUMBER(pin);
    switch (PIN_PORT(pin)) {
    case 0:
        return number < 8u ? number : CHANNEL_REF;
    case 1:
        return number < 2u ? 8u + number : CHANNEL_REF;
    case 2:
        return number < 6u ? 10u + number : CHANNEL_REF;
    default:
        return CHANNEL_REF;
    }
}

bool hal_analog_has(hal_pin pin)
{
    return hal_pin_is_free(pin) && channel_of(pin) != CHANNEL_REF;
}

/* The converter settles for 3 us. `runs` makes analog_clock() wait a whole millisecond, however soon it comes. */
static void start_converter(void)
{
    uint32_t before = io_hold();
    RCC_APB2ENR |= RCC_APB2ENR_ADC1;
    (void)RCC_APB2ENR;
    io_release(before);
    ADC_CCR = ADC_CCR_TSVREFE | (clock_apb2_hz() > FAST_BUS_HZ ? ADC_CCR_DIV4 : 0);
    ADC1_SMPR1 = ALL_LONGEST_1;
    ADC1_SMPR2 = ALL_LONGEST;
    ADC1_CR1 = ADC_CR1_EOCIE | ADC_CR1_OVRIE | ADC_CR1_SCAN;
    ADC1_CR2 = ADC_CR2_ADON | ADC_CR2_EOCS;
    io_interrupt_on(ADC_IRQ);
    inputs[0].channel = CHANNEL_REF;
    inputs[0].pin = HAL_PIN_NONE;
    run.runs = true;
}

static struct analog_input *find_input(hal_pin pin)
{
    for (unsigned i = 1; i < run.n; i++) {
        if (inputs[i].pin == pin) {
            return &inputs[i];
        }
    }
    return NULL;
}

enum err hal_analog_open(hal_pin pin)
{
    if (!hal_analog_has(pin)) {
        return ERR_RANGE;
    }
    struct analog_input *a = find_input(pin);
    if (a == NULL && run.n > INPUTS_MOST) {
        return ERR_FULL;
    }
    pin_make_analog(pin);
    if (a != NULL) {
        return ERR_OK;
    }
    if (run.n == 0) {
        start_converter();
        run.n = 1;
    }
    inputs[run.n].channel = (uint8_t)channel_of(pin);
    inputs[run.n].pin = pin;
    __asm volatile("" ::: "memory");
    run.n = (uint8_t)(run.n + 1u); /* the next scan has it */
    return ERR_OK;
}

/* A place in the sequence holds five bits, a register six places. */
static void set_sequence(unsigned n)
{
    uint32_t words[3] = {0, 0, (n - 1u) << 20};
    for (unsigned i = 0; i < n; i++) {
        words[i / FIRST_WORD] |= (uint32_t)inputs[i].channel << 5u * (i % FIRST_WORD);
    }
    ADC1_SQR3 = words[0];
    ADC1_SQR2 = words[1];
    ADC1_SQR1 = words[2];
}

void analog_clock(void)
{
    if (run.n == 0) {
        return;
    }
    if (run.runs ||
        (ADC1_SR & ADC_SR_OVR) != 0) { /* 9 conversions take 0.2 ms: this one has stopped */
        ADC1_CR2 = ADC_CR2_EOCS;
        (void)ADC1_DR;
        ADC1_SR = 0;
        ADC1_CR2 = ADC_CR2_ADON | ADC_CR2_EOCS; /* it settles until the next millisecond */
        run.runs = false;
        return;
    }
    if (run.going != run.n) {
        run.going = run.n;
        set_sequence(run.going);
    }
    run.scanned = 0;
    run.runs = true;
    ADC1_CR2 = ADC_CR2_ADON | ADC_CR2_EOCS | ADC_CR2_SWSTART;
}

static void add_conversion(struct analog_input *a, uint16_t code)
{
    a->sum = a->sum + code - a->last[a->next];
    a->last[a->next] = code;
    a->next = (uint8_t)((a->next + 1u) % MEAN);
    if (a->n < MEAN) {
        a->n++;
    }
    if (a->n == MEAN) {
        a->meaned = a->sum + 1u;
    }
}

void interrupt_adc(void)
{
    uint32_t status = ADC1_SR;
    if ((status & ADC_SR_OVR) != 0 || !run.runs) {
        ADC1_SR = ~(ADC_SR_OVR | ADC_SR_EOC) & ADC_SR_ALL; /* analog_clock() begins anew */
        return;
    }
    add_conversion(&inputs[run.scanned], (uint16_t)ADC1_DR);
    run.scanned++;
    if (run.scanned == run.going) {
        run.runs = false;
    }
}

/* 16 conversions of at most 4095 are 65520: what is missing to full scale grows with them. */
static uint32_t full_scale(uint32_t sum)
{
    return sum + (sum >> 12);
}

bool hal_analog_read(hal_pin pin, uint16_t *code)
{
    const struct analog_input *a = find_input(pin);
    uint32_t meaned = a == NULL ? 0 : a->meaned;
    if (meaned == 0) {
        return false;
    }
    *code = (uint16_t)full_scale(meaned - 1u);
    return true;
}

float hal_analog_reference(void)
{
    uint32_t meaned = inputs[0].meaned;
    return meaned <= 1u ? 0.0f : FACTORY_V * (float)(VREFIN_CAL * MEAN) / (float)(meaned - 1u);
}
