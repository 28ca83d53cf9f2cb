#ifndef REFLUX_HOST_SIM_REFLUX_SIM_H
#define REFLUX_HOST_SIM_REFLUX_SIM_H

/* The whole program; main() does nothing else, but for one that adds a transport of its own first. */
int reflux_sim(int argc, char **argv);

#endif
