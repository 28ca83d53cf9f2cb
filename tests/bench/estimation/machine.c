/* Support of an image without an operating system: start, the timer that counts one for each instruction, the
 * stack's paint, numbers that look random, lines on USART1. */
#include "cost.h"

#define REG32(address) (*(volatile uint32_t *)(address))
/* RM0090: TIM2, USART1, and the coprocessors' access of the core. */
#define TIM2_CR1    REG32(0x40000000u)
#define TIM2_EGR    REG32(0x40000014u)
#define TIM2_PSC    REG32(0x40000028u)
#define TIM2_ARR    REG32(0x4000002Cu)
#define RCC_APB1ENR REG32(0x40023840u)
#define RCC_APB2ENR REG32(0x40023844u)
#define USART1_SR   REG32(0x40011000u)
#define USART1_DR   REG32(0x40011004u)
#define USART1_CR1  REG32(0x4001100Cu)
#define SCB_CPACR   REG32(0xE000ED88u)

#define PAINT 0xA5A5A5A5u

extern uint32_t stack_bottom[], stack_top[], bss_start[], bss_end[];

int main(void);
void reset_entry(void);
void nothing(void);

union vector {
    void (*handler)(void);
    const void *address;
};
__attribute__((section(".vectors"), used)) static const union vector vectors[16] = {
    [0] = {.address = stack_top},
    [1] = {.handler = reset_entry},
    [2 ... 15] = {.handler = nothing},
};

void nothing(void)
{
    for (;;) {
    }
}

void cost_add(struct cost *c, uint32_t from, uint32_t to)
{
    uint32_t between = cost_now();
    between = cost_now() - between;
    cost_sum(c, to - from - between);
}

void cost_sum(struct cost *c, uint32_t spent)
{
    c->sum += spent;
    c->most = spent > c->most ? spent : c->most;
    c->count++;
}

static uintptr_t stack_pointer(void)
{
    uintptr_t here;
    __asm volatile("mov %0, sp" : "=r"(here));
    return here;
}

/* Only what lies well below the caller's frame. */
void cost_paint_stack(void)
{
    uintptr_t end = stack_pointer() - 64u;
    for (volatile uint32_t *p = stack_bottom; (uintptr_t)p < end; p++)
        *p = PAINT;
}

void cost_stack(struct cost *c)
{
    uintptr_t here = stack_pointer();
    const volatile uint32_t *p = stack_bottom;
    while ((uintptr_t)p < here && *p == PAINT)
        p++;
    uint32_t used = (uint32_t)(here - (uintptr_t)p);
    c->stack = used > c->stack ? used : c->stack;
}

static uint32_t seed;

void cost_seed(uint32_t begin)
{
    seed = begin;
}

float cost_random(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (float)(int32_t)seed / 2147483648.0f;
}

static void put(char c)
{
    while (!(USART1_SR & 0x80u)) {
    }
    USART1_DR = (uint8_t)c;
}

static void put_number(uint32_t x)
{
    char digits[10];
    unsigned n = 0;
    do {
        digits[n++] = (char)('0' + x % 10u);
        x /= 10u;
    } while (x);
    while (n)
        put(digits[--n]);
}

void cost_say(const char *what, unsigned n, uint32_t mean, uint32_t most, uint32_t bytes)
{
    const uint32_t numbers[] = {n, mean, most, bytes};
    for (; *what; what++)
        put(*what);
    for (unsigned k = 0; k < 4; k++) {
        put(' ');
        put_number(numbers[k]);
    }
    put('\n');
}

void cost_tell(const char *what, unsigned n, const struct cost *c, uint32_t bytes)
{
    cost_say(what, n, c->sum / c->count, c->most, bytes);
    cost_say("stack", n, c->stack, c->stack, 0);
}

void reset_entry(void)
{
    SCB_CPACR |= 0xFu << 20; /* the floating-point unit */
    __asm volatile("dsb\n\tisb");
    for (uint32_t *p = bss_start; p < bss_end; p++)
        *p = 0;
    seed = 1;
    RCC_APB1ENR |= 1u;
    RCC_APB2ENR |= 1u << 4;
    TIM2_PSC = 0;
    TIM2_ARR = UINT32_MAX;
    TIM2_EGR = 1;
    TIM2_CR1 = 1;
    USART1_CR1 = 0x2008u; /* on, sends */
    (void)main();
}
