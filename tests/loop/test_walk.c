/* A random walk: the whole firmware with all kinds of blocks that tests have, on the wood-berry column. Every step is something typed
 * or something that happens, drawn by chance; after every sample what has to hold always is looked at.
 *
 * A longer walk, or one walk again:
 *     WALK_SEED=7 WALK_SEEDS=1000 WALK_STEPS=2000 build/host/tests/loop/test_walk       WALK_LOG=1 prints what is done */
#include "walk_bench.h"
#include "walk_words.h"

/* ---- settings ---- */

static void sets_up(void)
{
    unsigned which = below(sizeof walk_starts / sizeof walk_starts[0]);
    char text[40];
    (void)types("abandon");
    (void)types("commission discard");
    (void)types("seq abort");
    goes_on(2);
    snprintf(text, sizeof text, "-- sets up %u", which);
    does(text);
    char line[256];
    FILE *file = fopen(WORKED_FAMILY_CONF, "r");
    TEST_ASSERT_NOT_NULL(file);
    while (fgets(line, sizeof line, file)) {
        line[strcspn(line, "\r\n")] = '\0';
        if (!line[0] || line[0] == '#')
            continue;
        if (strcmp(line, "apply") == 0) {
            snprintf(text, sizeof text, "set tick.base %g", board.tick_ms / 1000.0);
            ask_ok(text);
            for (unsigned i = 0; i < 48 && walk_starts[which][i]; i++)
                HOLDS(strcmp(ask(walk_starts[which][i]), "ok") == 0, "%s -> %s",
                      walk_starts[which][i], reply[n_reply - 1]);
            for (unsigned i = 0; i < sizeof walk_common / sizeof walk_common[0]; i++)
                (void)ask(walk_common[i]);
        }
        const char *end = ask(line);
        if (strcmp(end, "ok") != 0) {
            does(line);
            does(end);
        }
    }
    fclose(file);
    (void)types("abandon");
}

static void learns_names(void)
{
    ask_ok("list all");
    walk.names = 0;
    for (unsigned i = 0; i < n_reply && walk.names < PARAMETERS; i++) {
        char name[32];
        if (sscanf(reply[i], "%31s", name) == 1 && strchr(name, '.') &&
            strncmp(name, "console.", 8) != 0 && strncmp(name, "config.", 7) != 0)
            strcpy(walk.name[walk.names++], name);
    }
}

static void sets_something(void)
{
    char line[200];
    const char *name = walk.name[below(walk.names)];
    static const char *const often[] = {
        "loop1.", "loop2.", "loop3.",     "block1.", "block2.", "block3.",  "block4.",
        "mv1.",   "mv2.",   "lock1.",     "lock2.",  "lock3.",  "meas1.",   "meas2.",
        "meas3.", "ff1.",   "decouple1.", "alarm1.", "tick.",   "restart.", "step1."};
    const char *group = ANY(often);
    for (unsigned tries = 0; tries < 3000 && strncmp(name, group, strlen(group)) != 0; tries++)
        name = walk.name[below(walk.names)];
    if (one_in(2)) {
        snprintf(line, sizeof line, "get %s", name);
        double value;
        if (strcmp(ask(line), "ok") == 0 && n_reply >= 2) {
            const char *at = strstr(reply[0], " = ");
            if (sscanf(at ? at + 3 : reply[0] + strcspn(reply[0], " "), "%lf", &value) == 1) {
                static const double by[] = {0.5, 2, 1.1, 0.9, -1, 0, 1, 10, 0.1, 100};
                snprintf(line, sizeof line, "set %s %.7g", name,
                         value * ANY(by) + (one_in(3) ? 0.5 : 0));
                (void)types(line);
                return;
            }
        }
    }
    snprintf(line, sizeof line, "set %s %s", name, ANY(walk_words));
    (void)types(line);
}

static void number(char *line, size_t size, const char *head, double lo, double hi)
{
    snprintf(line, size, "%s %.6g", head, lo + (hi - lo) * below(1000) / 999.0);
    (void)types(line);
}

static void mischief(void)
{
    both_gives_up = one_in(4);
    both_adds = one_in(4) ? BY_FORMAT(NAN, 100.0f) : 0;
    mean_adds = one_in(4) ? BY_FORMAT(NAN, 100.0f) : 0;
    mean_again = one_in(2);
    pair_is_spent = one_in(2);
    pair_gives_up = one_in(6);
    stage_fails.fault = one_in(2) ? STAGE_WELL : (enum stage_fault)(1 + below(BY_FORMAT(2, 1)));
    stage_fails.call = (enum stage_call)below(3);
    stage_excites = (struct block_excitation){0};
    memset(wish, 0, sizeof wish);
    for (unsigned k = 0; k < 3; k++)
        if (one_in(2)) {
            struct block_excitation e = on((enum excite_what)below(4), (uint8_t)below(3), 0.02);
            if (k < 2)
                wish[k].ask[below(BLOCK_EXCITES_MAX)] = e;
            else
                stage_excites = e;
        }
    wish[0].gives_up = one_in(8);
    struct block_proposal *p = one_in(2) ? &watch_proposes : &pair_proposes;
    *p = (struct block_proposal){1,
                                 (uint8_t)below(2),
                                 {{proposed_setting(PROPOSED_LOOP_GAIN, (uint8_t)below(2)),
                                   0.5f + 0.1f * (float)below(20)}}};
    imp_mischief = one_in(3) ? 0 : 1 + below(3);
    does("mischief");
}

static void starts_again(bool power)
{
    does(power ? "power off and on" : "reset");
    if (power) {
        powers_on();
    } else {
        memory_port_reset(one_in(2) ? HAL_RESET_WATCHDOG : HAL_RESET_FAULT);
        board.ready = false;
        board_run();
        type("mode machine\n");
        board_forget();
    }
    if (power && walk.stored && walk.stored_tick_ms == board.tick_ms) {
        dumped(dump_b, sizeof dump_b);
        differs_where(walk.stored_dump, dump_b, "what was stored");
    }
    plant_connect();
    goes_on(2); /* then what is stored has been read */
    if (!walk.stored)
        sets_up();
}

/* The tick of the plant that it comes back with; 0: it does not fit the plant that is there. */
static uint32_t stored_for(void)
{
    return service_tick_fits(service(), service_plan(service())) ? board.tick_ms : 0;
}

static void saves(void)
{
    (void)types("abandon");
    if (service()->in_force != service()->newest)
        return;
    dumped(dump_a, sizeof dump_a);
    if (one_in(2)) {
        does("save, and power off in it");
        type("");
        TEST_ASSERT_EQUAL(5, memory_port_give(HAL_UART_CONSOLE, "save\n", 5));
        for (unsigned n = below(400); n; n--)
            memory_port_turn();
        powers_on();
        dumped(dump_b, sizeof dump_b);
        if (strcmp(dump_b, dump_a) == 0) {
            walk.stored = true;
            walk.stored_tick_ms = stored_for();
            memcpy(walk.stored_dump, dump_a, sizeof dump_a);
        } else if (walk.stored && walk.stored_tick_ms == board.tick_ms)
            differs_where(walk.stored_dump, dump_b, "neither the old nor the new");
        plant_connect();
        return;
    }
    if (types("save")) {
        walk.stored = true;
        walk.stored_tick_ms = stored_for();
        memcpy(walk.stored_dump, dump_a, sizeof dump_a);
    }
}

static void another_tick(void)
{
    static const uint32_t ticks[] = {60000, 30000, 120000, 60000, 1000};
    does("a plan with another tick");
    board.tick_ms = ANY(ticks);
    board.session++;
    board.mute = true;
    pass(3000);
    plant_connect();
    char line[60];
    snprintf(line, sizeof line, "set tick.base %g", one_in(3) ? 0 : board.tick_ms / 1000.0);
    (void)types(line);
}

static void happens(void)
{
    char line[80];
    switch (below(40)) {
    case 0:
        does("unplugged");
        board.mute = true;
        pass(3000 * below(3));
        goes_on(below(2));
        board.mute = false;
        pass(1000);
        if (!board.ready)
            plant_connect();
        break;
    case 1:
        starts_again(false);
        break;
    case 2:
        if (one_in(2))
            starts_again(true);
        else
            saves();
        break;
    case 3:
        if (one_in(3))
            another_tick();
        break;
    case 4:
    case 5:
    case 6: {
        if (!one_in(4)) {
            (void)types("mode top auto");
            (void)types("mode bottom auto");
            goes_on(1 + below(4));
            break;
        }
        static const float odd[] = {NAN, INFINITY, -INFINITY, 1e30f, 100, 0, 97, 130, -20, 5};
        unsigned i = below(2);
        odd_value[i] = ANY(odd);
        odd_quality[i] = (int)below(5) - 1;
        odd_left[i] = 1 + below(one_in(4) ? 30 : 3);
        snprintf(line, sizeof line, "odd %u: %g quality %d for %u", i, (double)odd_value[i],
                 odd_quality[i], odd_left[i]);
        does(line);
        break;
    }
    case 7:
        does("samples missing");
        plant_moves(1 + below(8));
        break;
    case 8: {
        unsigned n = 2 + below(14);
        snprintf(line, sizeof line, "%u samples at once", n);
        does(line);
        takes_a_sample(n);
        plant_moves(1);
        break;
    }
    case 9:
        does("the same moment again");
        takes_a_sample(1);
        takes_a_sample(1);
        plant_moves(1);
        break;
    case 10:
    case 11:
        mischief();
        break;
    case 12:
        if (one_in(3))
            sets_up();
        break;
    case 13:
        compares(twin_applies_nothing, "apply of nothing");
        break;
    case 14:
        if (one_in(4))
            compares(twin_pastes_its_dump, "dump pasted");
        break;
    case 15:
        if (one_in(4))
            restores();
        break;
    case 16: {
        static const char *const heads[] = {"sp top",  "out top",  "sp bottom", "out bottom",
                                            "sp trim", "out trim", "out R"};
        static const double lo[] = {94, 0, -2, 0, -2, -2, 0}, hi[] = {98, 4, 3, 4, 3, 3, 4};
        for (unsigned n = 3; n; n--) {
            unsigned k = below(7);
            number(line, sizeof line, heads[k], lo[k], hi[k]);
        }
        break;
    }
    case 17:
    case 18:
    case 19:
    case 20:
        goes_on(1 + below(12));
        break;
    case 21:
        (void)types("mode top auto");
        (void)types("mode bottom auto");
        goes_on(3);
        break;
    case 22:
    case 23:
    case 24:
    case 25:
    case 26:
    case 27:
        sets_something();
        break;
    case 28: {
        (void)types("begin");
        for (unsigned n = 1 + below(6); n; n--)
            sets_something();
        if (!types("apply"))
            (void)types("abandon");
        break;
    }
    default: {
        const char *line_ = ANY(walk_lines);
        if (strcmp(line_, "defaults") == 0 && !one_in(10))
            break;
        if (strcmp(line_, "save") == 0) {
            saves();
            break;
        }
        (void)types(line_);
    }
    }
    if (!one_in(3)) {
        takes_a_sample(1);
        plant_moves(1);
    }
}

static void walks(unsigned seed, unsigned steps)
{
    source.state = walk.seed = seed;
    imp_random.state = seed * 31u + 7u;
    imp_mischief = 0;
    walk.step = walk.n_done = 0;
    walk.stored = false;
    memset(odd_left, 0, sizeof odd_left);
    memory_port_erase_all();
    plant_power_on("wood-berry", TICK_MS, seed, 1);
    ask_file(WORKED_FAMILY_CONF);
    plant_connect();
    goes_on(2);
    sets_up();
    learns_names();
    ask_ok("out top 1.95");
    ask_ok("out bottom 1.71");
    goes_on(20);
    (void)types("mode top auto");
    (void)types("mode bottom auto");
    for (walk.step = 1; walk.step <= steps; walk.step++)
        happens();
    plant_power_off();
}

static unsigned of_environment(const char *name, unsigned otherwise)
{
    const char *text = getenv(name);
    return text ? (unsigned)strtoul(text, NULL, 10) : otherwise;
}

static void whatever_is_typed_or_happens_what_has_to_hold_holds(void)
{
    unsigned first = of_environment("WALK_SEED", 1), n = of_environment("WALK_SEEDS", 4);
    unsigned steps = of_environment("WALK_STEPS", 250);
    walk.prints = getenv("WALK_LOG") != NULL;
    for (unsigned k = 0; k < n; k++)
        walks(first + k, steps);
    printf("seeds %u..%u, %u steps each\n", first, first + n - 1, steps);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(whatever_is_typed_or_happens_what_has_to_hold_holds);
    return UNITY_END();
}
