/* What the core and its system control space stand for on the virtual board, on that of the STM32F405. Sections are those of PM0214 Rev 10. */
#include "board_registers.h"

#define STACK        0x20001004u /* no multiple of 8 */
#define FRAME        (STACK - 4u - 32u)
#define LONG_FRAME   (STACK - 4u - 104u) /* with the registers for numbers */
#define FPSCR_EQUAL  (BIT(30) | BIT(29))
#define MAIN         0x08000040u
#define NMI_AT       0x08000060u
#define HARD_AT      0x08000070u
#define PENDSV_AT    0x08000080u
#define VECTOR(at)   ((at) + 1u)
#define CODE(a, b)   ((uint32_t)(b) << 16 | (a))
#define WORD(at)     (((at)&0xFFFu) / 4u)
#define NOP          0xBF00u
#define STAY         0xE7FEu /* b . */
#define RETURN       0x4770u /* bx lr */
#define UNDEFINED    0xDE00u
#define R0_IS_0      0x2000u
#define LOAD_FROM_R0 0x6800u
#define PRIVDEFENA   MPU_CTRL_PRIVDEFENA
#define HFNMIENA     BIT(1)
#define HFSR_FORCED  BIT(30)
#define NOCP         BIT(19)
#define UNDEFINSTR   BIT(16)
#define ISER(n)      (0xE000E100u + 4u * (n))
#define ICER(n)      (0xE000E180u + 4u * (n))
#define ISPR(n)      (0xE000E200u + 4u * (n))
#define SHCSR_USAGE  BIT(18)
#define SCB_SCR      0xE000ED10u

static const struct masks open;

/* Code of the main program, n words; of the handlers of NMI, hard fault and PendSV. */
static void start_long(const uint32_t *code, unsigned n, uint32_t nmi, uint32_t hard,
                       uint32_t pendsv)
{
    uint32_t image[0x28] = {[0] = STACK,           [1] = VECTOR(MAIN),    [2] = VECTOR(NMI_AT),
                            [3] = VECTOR(HARD_AT), [6] = VECTOR(HARD_AT), [14] = VECTOR(PENDSV_AT)};
    const struct surroundings around = usual(&chip_stm32f405, 8000000);
    memcpy(&image[WORD(MAIN)], code, n * sizeof *code);
    image[WORD(NMI_AT)] = nmi;
    image[WORD(HARD_AT)] = hard;
    image[WORD(PENDSV_AT)] = pendsv;
    image[WORD(NMI_AT) + 1] = image[WORD(HARD_AT) + 1] = image[WORD(PENDSV_AT) + 1] =
        CODE(STAY, STAY);
    start_board(&chip_stm32f405, &around, (const uint8_t *)image, sizeof image);
}

static void start(uint32_t code, uint32_t nmi, uint32_t hard, uint32_t pendsv)
{
    const uint32_t codes[] = {code, CODE(STAY, STAY)};
    start_long(codes, 2, nmi, hard, pendsv);
}

void setUp(void)
{
    start(CODE(NOP, STAY), CODE(STAY, STAY), CODE(STAY, STAY), CODE(STAY, STAY));
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

static void run(void)
{
    board_run(b, board_ns(b) + 100000);
}

static uint32_t in_memory(uint32_t address)
{
    uint32_t found;
    const uint8_t *at = processor_memory(b, address, 4);
    TEST_ASSERT_NOT_NULL(at);
    (void)memcpy(&found, at, 4);
    return found;
}

static uint32_t in_frame(unsigned word)
{
    return in_memory(FRAME + 4u * word);
}

/* ---- 4.3, 2.3.5: interrupts ---- */

static void test_interrupts_are_enabled_and_pending_by_their_bits(void)
{
    put_ok(ISER(1), BIT(5) | BIT(6));
    put_ok(ISER(1), 0); /* zeros do nothing */
    TEST_ASSERT_EQUAL_HEX32(BIT(5) | BIT(6), get(ISER(1)));
    put_ok(ICER(1), BIT(5));
    TEST_ASSERT_EQUAL_HEX32(BIT(6), get(ISER(1)));
    put_ok(ISPR(1), BIT(5) | BIT(6));
    TEST_ASSERT_EQUAL(EXCEPTION_IRQ0 + 38, interrupts_pick(processor_interrupts(b), open, false));
    put_ok(NVIC_ICPR(1), BIT(6));
    TEST_ASSERT_EQUAL_HEX32(BIT(5), get(ISPR(1)));
    TEST_ASSERT_EQUAL(0, interrupts_pick(processor_interrupts(b), open, false));
    put_ok(ISER(2), BIT(17));
    put(ISER(2), BIT(18)); /* RM0090 Rev 21 12.1.1 */
    expect_verdict("has no interrupt 82");
}

static void test_the_most_urgent_comes_first_and_of_equals_the_lowest_number(void)
{
    struct interrupts *i = processor_interrupts(b);
    put_ok(ISER(1), BIT(5) | BIT(6));
    put_ok(ISPR(1), BIT(5) | BIT(6));
    TEST_ASSERT_EQUAL(EXCEPTION_IRQ0 + 37, interrupts_pick(i, open, false));
    bus_write(b, NVIC_IPR(37), 1, 0xFF);
    TEST_ASSERT_EQUAL_HEX32(0xF0u, bus_read(b, NVIC_IPR(37), 1) & 0xFFu); /* four bits */
    TEST_ASSERT_EQUAL(EXCEPTION_IRQ0 + 38, interrupts_pick(i, open, false));
    bus_write(b, NVIC_IPR(38), 1, 0x40);
    TEST_ASSERT_EQUAL(EXCEPTION_IRQ0 + 38,
                      interrupts_pick(i, (struct masks){.basepri = 0x50}, false));
    TEST_ASSERT_EQUAL(0, interrupts_pick(i, (struct masks){.basepri = 0x40}, false));
    TEST_ASSERT_EQUAL(0, interrupts_pick(i, (struct masks){.primask = true}, false));
    TEST_ASSERT_EQUAL(EXCEPTION_IRQ0 + 38, /* 2.5.2: it wakes the core */
                      interrupts_pick(i, (struct masks){.primask = true}, true));
    put_ok(SCB_ICSR, BIT(31)); /* NMI */
    TEST_ASSERT_EQUAL(EXCEPTION_NMI, interrupts_pick(i, (struct masks){.faultmask = true}, false));
}

/* ---- 4.4 ---- */

static void test_the_control_block(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x410FC241u, get(0xE000ED00u));
    TEST_ASSERT_EQUAL_HEX32(0x200u, get(SCB_CCR));
    TEST_ASSERT_EQUAL_HEX32(0xFA050000u, get(SCB_AIRCR));
    TEST_ASSERT_EQUAL_HEX32(BIT(11), get(SCB_ICSR)); /* RETTOBASE */
    put_ok(SCB_ICSR, SCB_ICSR_PENDSVSET);
    TEST_ASSERT_EQUAL_HEX32(SCB_ICSR_PENDSVSET | BIT(11), get(SCB_ICSR));
    put_ok(SCB_ICSR, SCB_ICSR_PENDSVCLR);
    TEST_ASSERT_EQUAL_HEX32(BIT(11), get(SCB_ICSR));
    put_ok(SCB_AIRCR, 4); /* without the key */
    TEST_ASSERT_FALSE(b->reset_asked);
    put(SCB_AIRCR, 0x05FA0500u);
    expect_verdict("groups of priorities are not modelled");
    put(SCB_AIRCR, 0x05FA0001u);
    expect_verdict("AIRCR of 0x05fa0001");
    put_ok(SCB_AIRCR, SCB_AIRCR_RESET);
    TEST_ASSERT_TRUE(b->reset_asked);
    TEST_ASSERT_EQUAL(RESET_SOFTWARE, b->reset_kind);
    put(SCB_VTOR, 0x08000080u); /* bits 8:0 are kept clear */
    expect_verdict("reserved bits 0x00000080");
    put(SCB_CCR, 0x208u);
    expect_verdict("traps of unaligned access are not modelled");
    put(SCB_SCR, 4);
    expect_verdict("deep sleep");
    (void)bus_read(b, SCB_ICSR, 1); /* 4.4.18 */
    expect_verdict("which takes no such width");
    bus_write(b, SCB_SHPR(14), 1, 0xFFu);
    TEST_ASSERT_EQUAL_HEX32(0xF0u, bus_read(b, SCB_SHPR(14), 1) & 0xFFu);
}

/* ---- 4.5: SysTick ---- */

static void cycles(uint64_t n)
{
    b->cycles += n;
    systick_run(processor_interrupts(b));
}

static void test_the_tick_counts_down_and_starts_anew(void)
{
    put_ok(SYST_RVR, 99);
    put_ok(SYST_CVR, 1);
    put_ok(SYST_CSR, SYST_CSR_ENABLE | SYST_CSR_CLKSOURCE);
    cycles(60);
    TEST_ASSERT_EQUAL(40, get(SYST_CVR));
    TEST_ASSERT_EQUAL_HEX32(SYST_CSR_ENABLE | SYST_CSR_CLKSOURCE, get(SYST_CSR));
    cycles(40);
    TEST_ASSERT_EQUAL_HEX32(SYST_CSR_ENABLE | SYST_CSR_CLKSOURCE | SYST_CSR_COUNTFLAG,
                            get(SYST_CSR));
    TEST_ASSERT_EQUAL_HEX32(SYST_CSR_ENABLE | SYST_CSR_CLKSOURCE, get(SYST_CSR)); /* read once */
    TEST_ASSERT_FALSE(interrupts_any(processor_interrupts(b)));
    put_ok(SYST_CSR, SYST_CSR_ENABLE | SYST_CSR_CLKSOURCE | SYST_CSR_TICKINT);
    cycles(100);
    TEST_ASSERT_EQUAL(EXCEPTION_SYSTICK, interrupts_pick(processor_interrupts(b), open, false));
    put_ok(SYST_CVR, 5); /* clears the flag and the count */
    TEST_ASSERT_EQUAL(0, get(SYST_CSR) & SYST_CSR_COUNTFLAG);
    put_ok(SCB_ICSR, SCB_ICSR_PENDSTCLR);
    TEST_ASSERT_FALSE(interrupts_any(processor_interrupts(b)));
    put_ok(SYST_CSR, SYST_CSR_ENABLE); /* an eighth */
    cycles(799);
    TEST_ASSERT_EQUAL(0, get(SYST_CSR) & SYST_CSR_COUNTFLAG);
    cycles(1);
    TEST_ASSERT_EQUAL_HEX32(SYST_CSR_COUNTFLAG, get(SYST_CSR) & SYST_CSR_COUNTFLAG);
}

/* ---- cycle counter ---- */

static void test_the_cycle_counter_counts_once_the_trace_unit_is_on(void)
{
    put(DWT_CTRL, DWT_CTRL_CYCCNTENA);
    expect_verdict("write of DWT while DEMCR_TRCENA is off");
    board_power_on(b);
    put_ok(SCB_DEMCR, SCB_DEMCR_TRCENA);
    put_ok(DWT_CYCCNT, 7);
    put_ok(DWT_CTRL, get(DWT_CTRL) | DWT_CTRL_CYCCNTENA);
    b->cycles += 1000;
    TEST_ASSERT_EQUAL(1007, get(DWT_CYCCNT));
    restart(RESET_SOFTWARE); /* RM0090 Rev 21 38.10: debug registers outlive it */
    TEST_ASSERT_EQUAL_HEX32(SCB_DEMCR_TRCENA, get(SCB_DEMCR));
    TEST_ASSERT_TRUE(get(DWT_CYCCNT) >= 1007u);
    board_power_on(b);
    TEST_ASSERT_EQUAL_HEX32(0, get(SCB_DEMCR));
}

/* ---- 2.3.7: frames ---- */

static void test_an_exception_leaves_its_frame_on_an_aligned_stack(void)
{
    run();
    put_ok(SCB_ICSR, SCB_ICSR_PENDSVSET);
    run();
    TEST_ASSERT_EQUAL_HEX32(PENDSV_AT, processor_pc(b));
    TEST_ASSERT_EQUAL(14, get(SCB_ICSR) & 0x1FFu);
    TEST_ASSERT_EQUAL_HEX32(MAIN + 2u, in_frame(6));
    TEST_ASSERT_EQUAL_HEX32(BIT(24) | BIT(9), in_frame(7) & (BIT(24) | BIT(9) | 0x1FFu));
}

static void test_a_return_takes_the_frame_away_again(void)
{
    start(CODE(NOP, STAY), CODE(STAY, STAY), CODE(STAY, STAY), CODE(RETURN, STAY));
    run();
    for (unsigned i = 0; i < 3; i++) {
        put_ok(SCB_ICSR, SCB_ICSR_PENDSVSET);
        run();
        TEST_ASSERT_EQUAL_HEX32(MAIN + 2u, processor_pc(b));
        TEST_ASSERT_EQUAL(0, interrupts_depth(processor_interrupts(b)));
        TEST_ASSERT_EQUAL_HEX32(MAIN + 2u, in_frame(6)); /* at the same place each time */
    }
}

/* The result of a comparison lies in FPSCR when the interrupt comes, and is fetched after it. */
static void test_a_comparison_of_numbers_outlives_an_interrupt(void)
{
    static const uint32_t code[] = {
        CODE(R0_IS_0, NOP),     CODE(0xEE00u, 0x0A10u), /* vmov s0, r0 */
        CODE(0xEEB5u, 0x0A40u),                         /* vcmp.f32 s0, #0 */
        CODE(0xEEF1u, 0x1A10u),                         /* again: vmrs r1, fpscr */
        CODE(0xE7FCu, STAY),                            /* b again */
    };
    start_long(code, sizeof code / sizeof *code, CODE(STAY, STAY), CODE(STAY, STAY),
               CODE(RETURN, STAY));
    put_ok(SCB_CPACR, SCB_CPACR_FPU);
    run();
    put_ok(SCB_ICSR, SCB_ICSR_PENDSVSET);
    run();
    interrupt_nmi(b, true);
    run();
    TEST_ASSERT_EQUAL_HEX32(FPSCR_EQUAL, in_memory(LONG_FRAME + 4u)); /* r1 */
}

/* ---- 2.4: faults ---- */

static void test_a_fault_without_a_handler_of_its_own_is_a_hard_one(void)
{
    start(CODE(UNDEFINED, STAY), CODE(STAY, STAY), CODE(STAY, STAY), CODE(STAY, STAY));
    run();
    TEST_ASSERT_EQUAL_HEX32(HARD_AT, processor_pc(b));
    TEST_ASSERT_EQUAL(EXCEPTION_HARD_FAULT, get(SCB_ICSR) & 0x1FFu);
    TEST_ASSERT_EQUAL_HEX32(UNDEFINSTR, get(SCB_CFSR));
    TEST_ASSERT_EQUAL_HEX32(HFSR_FORCED, get(SCB_HFSR));
    TEST_ASSERT_EQUAL_HEX32(MAIN, in_frame(6)); /* 4.4.11: of the instruction itself */
    put_ok(SCB_CFSR, UNDEFINSTR);
    put_ok(SCB_HFSR, HFSR_FORCED);
    TEST_ASSERT_EQUAL_HEX32(0, get(SCB_CFSR) | get(SCB_HFSR));
    board_power_on(b);
    put_ok(SCB_SHCSR, SHCSR_USAGE);
    run();
    TEST_ASSERT_EQUAL(EXCEPTION_USAGE_FAULT, get(SCB_ICSR) & 0x1FFu);
    TEST_ASSERT_EQUAL_HEX32(0, get(SCB_HFSR));
}

/* 2.4.4 */
static void test_a_fault_in_a_hard_fault_locks_up_until_an_nmi(void)
{
    start(CODE(UNDEFINED, STAY), CODE(UNDEFINED, STAY), CODE(UNDEFINED, STAY), CODE(STAY, STAY));
    run();
    uint64_t instructions = b->instructions;
    run();
    TEST_ASSERT_EQUAL(instructions, b->instructions);
    interrupt_nmi(b, true);
    run();
    TEST_ASSERT_EQUAL(EXCEPTION_NMI, get(SCB_ICSR) & 0x1FFu);
    TEST_ASSERT_TRUE(b->instructions > instructions);
    instructions = b->instructions; /* which faults in its turn: no NMI leads out of that */
    run();
    TEST_ASSERT_EQUAL(instructions, b->instructions);
}

/* 4.6.1 */
static void test_the_unit_for_numbers_is_off_until_it_is_let(void)
{
    const uint32_t move = CODE(0xEE00u, 0x0A10u); /* vmov s0, r0 */
    start(move, CODE(STAY, STAY), CODE(STAY, STAY), CODE(STAY, STAY));
    run();
    TEST_ASSERT_EQUAL_HEX32(NOCP, get(SCB_CFSR));
    TEST_ASSERT_EQUAL_HEX32(MAIN, in_frame(6));
    board_power_on(b);
    put_ok(SCB_CPACR, SCB_CPACR_FPU);
    run();
    TEST_ASSERT_EQUAL_HEX32(0, get(SCB_CFSR));
    TEST_ASSERT_EQUAL_HEX32(MAIN + 4u, processor_pc(b));
}

/* ---- 4.2: protection unit ---- */

static void forbid_the_first_mebibyte(uint32_t control)
{
    put_ok(MPU_RNR, 0);
    put_ok(MPU_RBAR, 0x000FFFE0u); /* 4.2.8: below the size of the region it counts for nothing */
    put_ok(MPU_RASR, MPU_RASR_XN | MPU_RASR_AP_NONE | MPU_RASR_SIZE(20) | MPU_RASR_ENABLE);
    put_ok(MPU_CTRL, MPU_CTRL_ENABLE | PRIVDEFENA | control);
}

/* 4.2.6: a hard fault may reach what is forbidden, unless the unit is told to stay on. */
static void test_the_unit_is_off_in_a_hard_fault(void)
{
    start(CODE(UNDEFINED, STAY), CODE(STAY, STAY), CODE(R0_IS_0, LOAD_FROM_R0), CODE(STAY, STAY));
    forbid_the_first_mebibyte(0);
    run();
    TEST_ASSERT_EQUAL_HEX32(HARD_AT + 4u, processor_pc(b));
    TEST_ASSERT_EQUAL_HEX32(UNDEFINSTR, get(SCB_CFSR));
    board_power_on(b);
    forbid_the_first_mebibyte(HFNMIENA);
    run();
    TEST_ASSERT_EQUAL_HEX32(UNDEFINSTR | SCB_CFSR_MMARVALID | 2u, get(SCB_CFSR)); /* locked up */
}

static void test_what_the_unit_refuses(void)
{
    TEST_ASSERT_EQUAL_HEX32(8u << 8, get(MPU_TYPE));
    put_ok(MPU_RNR, 8);
    put(MPU_RBAR, 0);
    expect_verdict("has no region 8");
    put_ok(MPU_RNR, 0);
    put(MPU_RBAR, 0x10u);
    expect_verdict("a region number within MPU_RBAR is not modelled");
    put_ok(MPU_CTRL, MPU_CTRL_ENABLE);
    run();
    expect_verdict("without the background map is not modelled");
    put_ok(MPU_CTRL, MPU_CTRL_ENABLE | PRIVDEFENA);
    put_ok(MPU_RASR, 3u << 24 | MPU_RASR_SIZE(20) | MPU_RASR_ENABLE); /* all may read */
    run();
    expect_verdict("of a form that is not modelled");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_interrupts_are_enabled_and_pending_by_their_bits);
    RUN_TEST(test_the_most_urgent_comes_first_and_of_equals_the_lowest_number);
    RUN_TEST(test_the_control_block);
    RUN_TEST(test_the_tick_counts_down_and_starts_anew);
    RUN_TEST(test_the_cycle_counter_counts_once_the_trace_unit_is_on);
    RUN_TEST(test_an_exception_leaves_its_frame_on_an_aligned_stack);
    RUN_TEST(test_a_return_takes_the_frame_away_again);
    RUN_TEST(test_a_comparison_of_numbers_outlives_an_interrupt);
    RUN_TEST(test_a_fault_without_a_handler_of_its_own_is_a_hard_one);
    RUN_TEST(test_a_fault_in_a_hard_fault_locks_up_until_an_nmi);
    RUN_TEST(test_the_unit_for_numbers_is_off_until_it_is_let);
    RUN_TEST(test_the_unit_is_off_in_a_hard_fault);
    RUN_TEST(test_what_the_unit_refuses);
    board_free(b);
    return UNITY_END();
}
