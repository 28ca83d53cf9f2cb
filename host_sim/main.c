#include "bench/reflux_sim.h"

int main(int argc, char **argv)
{
    return reflux_sim(argc, argv);
}
