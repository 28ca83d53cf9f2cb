#include "io/plant_fault.h"

#include "exchange/pins.h"

const char *plant_fault_text(uint8_t fault)
{
    static const char *const texts[PLANT_FAULTS] = {
        [PLANT_FINE] = "?",
        [PLANT_TOO_LARGE] = "more channels of a kind than this board takes",
        [PLANT_LONG_TEXT] = "more bytes of names and units than this board takes",
        [PLANT_HELLO] = "HELLO of another length, or with a text that is none",
        [PLANT_NO_TICK] = "tick_ms is 0",
        [PLANT_PAGE] = "PAGE malformed, or of the other kind",
        [PLANT_SPAN] = "PAGE with a span that is empty or no number, or safe outside it",
        [PLANT_SAME_NAME] = "PAGE with the name of another of its kind",
        [PLANT_NO_PAGE] = "PAGE does not come",
        [PLANT_SHAPE] = "samples of another shape than announced; measurements in them",
        [PLANT_ROLE] = "message of a controller: there is another, or the line echoes; type",
        [PLANT_AT_PINS] =
            CONFIG_DEVICES ? "channel with the name of one at the board's own pins" : "?",
    };
    return texts[fault < PLANT_FAULTS ? fault : PLANT_FINE];
}
