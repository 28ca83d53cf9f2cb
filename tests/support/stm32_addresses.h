/* The port's registers.h, with each register's name standing for its address. */
#ifndef REFLUX_TESTS_STM32_ADDRESSES_H
#define REFLUX_TESTS_STM32_ADDRESSES_H

#include "registers.h"

#undef REG32
#undef REG16
#undef REG8
#define REG32(address) (address)
#define REG16(address) (address)
#define REG8(address)  (address)

#endif
