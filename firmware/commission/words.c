#include "commission/words.h"

#include "base/assertion.h"

const char *words_of_verdict(const struct analysis *a)
{
    static const char *const words[] = {
        [PAIRING_DETERMINED] = "determined",
        [PAIRING_UNDETERMINED] = "not determined: the gains are not known well enough",
        [PAIRING_SINGULAR] = "not determined: within error, inputs act alike",
        [PAIRING_IMPOSSIBLE] = "impossible: no pairs with positive relative gains and indices"};
    REFLUX_ASSERT((unsigned)a->verdict < sizeof words / sizeof words[0]);
    unsigned doubts = certainty_doubts(&a->certainty);
    if (a->verdict != PAIRING_UNDETERMINED)
        return words[a->verdict];
    if (doubts & DOUBT_RANK)
        return words[PAIRING_SINGULAR];
    if (doubts == DOUBT_SHAPE)
        return "not determined: a response was not seen to its end";
    return words[PAIRING_UNDETERMINED];
}

const char *words_of_second(enum analysis_second second)
{
    return second == SECOND_AGREES    ? "agrees: gains over residence times give the same pairs"
           : second == SECOND_DIFFERS ? "differs: gains over residence times give other pairs; see "
                                        "the dynamic relative gains"
                                      : "";
}

const char *words_of_no_design(enum err reason)
{
    return reason == ERR_FULL          ? "more loops than this board runs"
           : reason == ERR_UNSUPPORTED ? "the settings exceed a loop's range: choose other spans"
           : reason == ERR_TIMEOUT     ? "no settings are slow enough to be stable"
                                       : "the settings are not stable on the model";
}

const char *words_of_decoupler(enum analysis_decoupler decoupler)
{
    static const char *const words[] = {
        [DECOUPLER_USED] = "static, where single loops are not enough",
        [DECOUPLER_NOT_NEEDED] = "none: single loops are enough",
        [DECOUPLER_TOO_MANY] = "none: too many loops for a decoupler",
        [DECOUPLER_ILL] = "none: the inverse of the gains would amplify their errors",
        [DECOUPLER_NO_BETTER] = "none: single loops do as well"};
    return words[decoupler];
}

const char *words_of_feed(enum feed_verdict verdict)
{
    static const char *const words[] = {[FEED_NONE] = "",
                                        [FEED_USED] = "yes",
                                        [FEED_COMPANY] = "no: its loop shares a block with others",
                                        [FEED_LATE] = "no: it would come too late",
                                        [FEED_LARGE] =
                                            "no: gain or times exceed an element's range",
                                        [FEED_FULL] = "no: stronger ones take all places"};
    return words[verdict];
}

const char *words_of_left(enum left_over reason)
{
    static const char *const words[] = {[LEFT_NOT] = "",
                                        [LEFT_UNSEEN] = "none of its gains exceeds its error",
                                        [LEFT_OVER] = "surplus: the pairs are better without it"};
    return words[reason];
}

bool words_of_doubt(const struct analysis *a, unsigned n, struct words_doubt *doubt)
{
    const struct words_doubt all[WORDS_DOUBTS] = {
        {"rank", "within error, inputs act alike", (real_t)a->rank},
        {"determinant", "standard deviations from zero; 2 needed", a->determinant}};
    static const uint8_t bits[WORDS_DOUBTS] = {DOUBT_RANK, DOUBT_DETERMINANT};
    if (n >= WORDS_DOUBTS || (certainty_doubts(&a->certainty) & bits[n]) == 0u)
        return false;
    *doubt = all[n];
    return true;
}
