/* Fields that have moved since they were first stored. Ids are for ever, so this is for a field that becomes part of
 * another group; a field whose name alone changes keeps its id and needs nothing. */
#include "storage/storage_record.h"

const struct storage_rename storage_renames[] = {
    {0, 0},
};
