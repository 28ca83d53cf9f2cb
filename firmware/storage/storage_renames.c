/* Fields that have moved since they were first stored. Ids never change, so the table is for a field that becomes part of
 * another group. A field whose name alone changes keeps its id and needs no row. */
#include "storage/storage_record.h"

const struct storage_rename storage_renames[] = {
    {0, 0},
};
