#include "plant_inputs.h"

#include "text.h"

/* An earlier change of the same channel still waits. */
static bool must_wait(const struct plant_change *change, const bool *done, size_t k)
{
    for (size_t i = 0; i < k; i++) {
        if (!done[i] && change[i].channel == change[k].channel) {
            return true;
        }
    }
    return false;
}

bool plant_set_inputs(const struct plant_class *class, struct plant *p,
                      const struct plant_change *change, size_t n, char *err, size_t err_size)
{
    bool done[PLANT_CHANGES_MAX] = {false};
    size_t left = n, before = n + 1;
    if (n > PLANT_CHANGES_MAX) {
        return sim_fail(err, err_size, "%s: more than %zu inputs change at a time", class->name,
                        PLANT_CHANGES_MAX);
    }
    while (left > 0 && left < before) { /* each round sets one more at least */
        bool said = false;
        before = left;
        for (size_t k = 0; k < n; k++) {
            char reason[SIM_ERROR_SIZE] = "";
            if (done[k] || must_wait(change, done, k)) {
                continue;
            }
            if (class->set_input(p, change[k].channel, change[k].value, reason, sizeof(reason))) {
                done[k] = true;
                left--;
            } else if (!said) {
                said = true;
                (void)sim_fail(err, err_size, "%s", reason);
            }
        }
    }
    if (left == 0 && err_size > 0) {
        err[0] = '\0';
    }
    return left == 0;
}
