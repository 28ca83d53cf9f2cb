/* Counts the instructions of recursive least squares in several forms, and of the self-tuner, on the emulated STM32F405:
 * its timer TIM2 counts one for each instruction. Every figure is over 200 samples after the first 20; reading the counter
 * is taken off. */
#include <stdalign.h>
#include <stdbool.h>
#include <string.h>

#include "cost.h"
#include "identify/rls.h"
#include "num/ud_num.h"

#define REG32(address) (*(volatile uint32_t *)(address))
/* RM0090: TIM2, USART1, and the coprocessors' access of the core. */
#define TIM2_CR1    REG32(0x40000000u)
#define TIM2_EGR    REG32(0x40000014u)
#define TIM2_CNT    REG32(0x40000024u)
#define TIM2_PSC    REG32(0x40000028u)
#define TIM2_ARR    REG32(0x4000002Cu)
#define RCC_APB1ENR REG32(0x40023840u)
#define RCC_APB2ENR REG32(0x40023844u)
#define USART1_SR   REG32(0x40011000u)
#define USART1_DR   REG32(0x40011004u)
#define USART1_CR1  REG32(0x4001100Cu)
#define SCB_CPACR   REG32(0xE000ED88u)

#define SAMPLES 220u
#define FIRST   20u
#define PAINT   0xA5A5A5A5u

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

uint32_t cost_now(void)
{
    return TIM2_CNT;
}

void cost_add(struct cost *c, uint32_t from, uint32_t to)
{
    uint32_t between = cost_now();
    between = cost_now() - between;
    uint32_t spent = to - from - between;
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

uint32_t cost_stack_used(void)
{
    uintptr_t here = stack_pointer();
    const volatile uint32_t *p = stack_bottom;
    while ((uintptr_t)p < here && *p == PAINT)
        p++;
    return (uint32_t)(here - (uintptr_t)p);
}

static uint32_t seed;

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

static num_t phi[RLS_MAX];

static void next_sample(unsigned n)
{
    for (unsigned i = 0; i + 1 < n; i++)
        phi[i] = num_from_float(cost_random());
    phi[n - 1] = num_one();
}

static void cost_of_rls(unsigned n)
{
    static alignas(8) char memory[3000];
    static float p0[RLS_MAX];
    static num_t theta[RLS_MAX];
    struct rls *r = (struct rls *)(void *)memory;
    struct rls_settings s;
    struct cost cost = {0};
    memset(&s, 0, sizeof s);
    for (unsigned i = 0; i < n; i++)
        p0[i] = 100;
    s.n = (uint8_t)n;
    s.p0 = p0;
    s.forget = 0.98f;
    s.forget_least = 0.2f;
    s.sigma0 = s.memory = s.trace = 1;
    rls_init(r, &s, theta);
    for (unsigned t = 0; t < SAMPLES; t++) {
        next_sample(n);
        num_t y = num_from_float(cost_random());
        uint32_t from = cost_now();
        (void)rls_step(r, phi, y, true);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to);
    }
    cost_say("step", n, cost.sum / cost.count, cost.most, rls_bytes(n));
}

static void cost_of_update(unsigned n)
{
    static ud_cell_t ud[RLS_MAX * (RLS_MAX + 1) / 2 + 2 * RLS_MAX];
    static scaled_t f[RLS_MAX], g[RLS_MAX];
    struct cost cost = {0};
    scaled_t v = scaled_from_float(0.98f), growth = scaled_from_float(1 / 0.98f);
    for (unsigned i = 0; i < n; i++)
        f[i] = scaled_from_float(100);
    ud_num_set_diagonal(ud, n, f);
    for (unsigned t = 0; t < SAMPLES; t++) {
        next_sample(n);
        uint32_t from = cost_now();
        ud_num_project(ud, n, phi, f, g);
        (void)ud_num_correct(ud, n, f, g, v, growth);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to);
    }
    cost_say("update", n, cost.sum / cost.count, cost.most,
             (uint32_t)(ud_num_cells(n) * sizeof(ud_cell_t)));
}

#ifndef REFLUX_FIXED_POINT
static void cost_of_form(const char *what, unsigned n,
                         float (*form)(float *, size_t, const float *, float, float *))
{
    static float p[RLS_MAX * RLS_MAX], gain[RLS_MAX];
    struct cost cost = {0};
    memset(p, 0, sizeof p);
    for (unsigned i = 0; i < n; i++)
        p[i * n + i] = 100;
    for (unsigned t = 0; t < SAMPLES; t++) {
        next_sample(n);
        uint32_t from = cost_now();
        (void)form(p, n, phi, 0.98f, gain);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to);
    }
    cost_say(what, n, cost.sum / cost.count, cost.most, (uint32_t)(n * n * sizeof(float)));
}
#endif

int main(void)
{
    static const unsigned sizes[] = {6, 9, 12, 24};
    for (unsigned k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        seed = 1;
        cost_of_update(sizes[k]);
        seed = 1;
        cost_of_rls(sizes[k]);
#ifndef REFLUX_FIXED_POINT
        seed = 1;
        cost_of_form("covariance", sizes[k], covariance_form);
        seed = 1;
        cost_of_form("joseph", sizes[k], joseph_form);
        seed = 1;
        cost_of_form("dense", sizes[k], dense_form);
#endif
    }
    cost_of_tuners();
    cost_of_trays();
    cost_say("done", 0, 0, 0, 0);
    for (;;) {
    }
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
