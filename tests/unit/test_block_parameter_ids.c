/* Guards a promise to owners of stored sets: a set that was saved years ago means the same to later firmware. A set holds the ids of a
 * block's parameters, their types and shapes, and the numbers behind their words, so none of them may ever mean something else.
 *
 * Kept in reference/block_parameter_ids.txt, which support/kept_transcript.h says how to write anew. Lines and words may be added, ranges
 * may widen, and a default may change for a reason. */
#include "block/block.h"
#include "kept_transcript.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void a_parameter_of_a_block_keeps_its_id_its_shape_and_its_words(void)
{
    static const char *const types[] = {
        [BLOCK_FLOAT] = "float", [BLOCK_U16] = "u16", [BLOCK_WORD] = "word"};
    kept_open("reference/block_parameter_ids.txt",
              "a block saved years ago means the same to later firmware");
    for (unsigned k = 0; k < block_kind_count; k++) {
        const struct block_kind *kind = block_kinds[k];
        kept_line("# %s", kind->name);
        for (unsigned i = 0; i < kind->parameters; i++) {
            const struct block_parameter *p = &kind->parameter[i];
            kept_line("%u %s %s %u x %u %g %g %g%s%s", p->id, p->name, types[p->type], p->rows,
                      p->cols, (double)p->lo, (double)p->hi, (double)p->initial,
                      p->type == BLOCK_WORD ? " " : "", p->type == BLOCK_WORD ? p->unit : "");
        }
    }
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_parameter_of_a_block_keeps_its_id_its_shape_and_its_words);
    return UNITY_END();
}
