#include "exchange/config.h"

#include "commission/words.h"

const char *words_of_verdict(const struct analysis *a)
{
    static const char *const words[] = {
        [PAIRING_DETERMINED] = "determined",
        [PAIRING_UNDETERMINED] = "not determined: the gains are not known well enough",
        [PAIRING_SINGULAR] = "not determined: fewer directions than channels",
        [PAIRING_IMPOSSIBLE] = "impossible: no pairs with positive relative gains and indices"};
    const unsigned shape = DOUBT_SHAPE | DOUBT_SHAPE_FINAL;
    if (a->verdict != PAIRING_UNDETERMINED)
        return words[a->verdict];
    if (a->doubts & DOUBT_RANK)
        return words[PAIRING_SINGULAR];
    if (a->doubts == DOUBT_SHAPE)
        return "not determined: a response was not seen to its end";
    if ((a->doubts & ~shape) == 0)
        return "not determined: a response is not one that loops are made for";
    if ((a->doubts & ~(shape | DOUBT_SECOND)) == 0)
        return "not determined: gains over residence times give other pairs";
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
    return reason == ERR_FULL ? "more loops than this board runs"
           : reason == ERR_UNSUPPORTED
               ? "the settings are outside of what a loop takes: other spans are needed"
           : reason == ERR_TIMEOUT ? "no settings are slow enough to be stable"
                                   : "the settings are not stable on the model";
}

const char *words_of_decoupler(enum analysis_decoupler decoupler)
{
    static const char *const words[] = {
        [DECOUPLER_USED] = "static, for the blocks that single loops would not serve",
        [DECOUPLER_NOT_NEEDED] = "none: single loops serve",
        [DECOUPLER_TOO_MANY] = "none: more loops than a decoupler spans",
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
                                            "no: gain or times are more than an element takes",
                                        [FEED_FULL] = "no: stronger ones take all the places"};
    return words[verdict];
}

const char *words_of_left(enum left_over reason)
{
    static const char *const words[] = {
        [LEFT_NOT] = "",
        [LEFT_UNSEEN] = "no gain of it stands out of its errors",
        [LEFT_OVER] = "there are more of its kind than of the other, which go better without it"};
    return words[reason];
}

bool words_of_doubt(const struct analysis *a, unsigned n, struct words_doubt *doubt)
{
    const struct words_doubt all[WORDS_DOUBTS] = {
        {"rank", "fewer directions than pairs stand out of the errors of the gains",
         (real_t)a->rank},
        {"determinant", "standard deviations from 0, where 2 are wanted", a->determinant},
        {"integrity", "share of draws in which any loops may be in manual, where 0.9 is wanted",
         a->integrity}};
    static const uint8_t bits[WORDS_DOUBTS] = {DOUBT_RANK, DOUBT_DETERMINANT, DOUBT_INTEGRITY};
    if (n >= WORDS_DOUBTS || (a->doubts & bits[n]) == 0u)
        return false;
    *doubt = all[n];
    return true;
}
