/* reflux-sim with the firmware inside: --port memory --console memory. */
#include "bench/reflux_sim.h"
#include "memory_transport.h"

int main(int argc, char **argv)
{
    transport_add_scheme("memory", memory_transport_open);
    return reflux_sim(argc, argv);
}
