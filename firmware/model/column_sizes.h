/* Largest column this build can hold. Both may be given on the compiler's command line. */
#ifndef REFLUX_MODEL_COLUMN_SIZES_H
#define REFLUX_MODEL_COLUMN_SIZES_H

#if defined REFLUX_REAL_DOUBLE || defined REFLUX_REAL_LONG /* host */
#ifndef COLUMN_STAGES_MAX
#define COLUMN_STAGES_MAX 200
#endif
#ifndef COLUMN_COMPONENTS_MAX
#define COLUMN_COMPONENTS_MAX 10
#endif
#else /* firmware */
#ifndef COLUMN_STAGES_MAX
#define COLUMN_STAGES_MAX 40
#endif
#ifndef COLUMN_COMPONENTS_MAX
#define COLUMN_COMPONENTS_MAX 4
#endif
#endif

/* 0: no holdup moves in this build, and configs in which one does are refused. */
#ifndef COLUMN_HOLDUPS_MOVE
#define COLUMN_HOLDUPS_MOVE 1
#endif

#define COLUMN_STATES_MAX (COLUMN_STAGES_MAX * (COLUMN_COMPONENTS_MAX - 1))

#endif
