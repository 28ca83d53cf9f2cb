/* The large memory that the firmware leases (base/workspace.h): WORKSPACE_BYTES. Where that is 0 a board has none, and no such function. */
#ifndef REFLUX_HAL_WORKSPACE_H
#define REFLUX_HAL_WORKSPACE_H

/* Returns the memory, cleared and aligned for everything. Call once, at the start of the firmware. A board may have it where only the
 * processor reaches: no DMA may read or write there, and no code may lie there. */
void *hal_workspace(void);

#endif
