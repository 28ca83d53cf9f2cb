# The distribution's bare-metal Arm compiler with picolibc. Processor flags come with the board.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_ASM_COMPILER arm-none-eabi-gcc)
set(CMAKE_OBJCOPY arm-none-eabi-objcopy)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)

set(REFLUX_CPU_stm32f405 "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16")
# Inlining what is called once would make every caller carry the largest frame below it: 8 KiB is all there is.
set(REFLUX_CPU_stm32f100 "-mcpu=cortex-m3 -mthumb -mfloat-abi=soft -fno-inline-functions-called-once -fconserve-stack")
if(NOT REFLUX_BOARD)
  set(REFLUX_BOARD stm32f405)
endif()
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES REFLUX_BOARD)
set(CMAKE_C_FLAGS_INIT "${REFLUX_CPU_${REFLUX_BOARD}} --specs=picolibc.specs")
set(CMAKE_ASM_FLAGS_INIT "${REFLUX_CPU_${REFLUX_BOARD}}")
# Two passes that spend flash here even under -Os, found by leaving out one after the other: 0.7 KB together.
set(CMAKE_C_FLAGS_MINSIZEREL_INIT "-Os -g -fno-tree-forwprop -fno-schedule-insns2")
