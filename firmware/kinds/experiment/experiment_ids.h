/* Ids of the parameters of the kind `experiment` that it proposes itself. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_IDS_H
#define REFLUX_EXPERIMENT_EXPERIMENT_IDS_H

#define EXPERIMENT_ID_KNOWN 16
/* By outputs. */
#define EXPERIMENT_ID_A 20
/* By outputs and inputs. */
#define EXPERIMENT_ID_B 30

#endif
