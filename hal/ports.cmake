# What puts a port under the firmware; included after the firmware's layers exist. Ports are object libraries:
# port and firmware call each other, which archives linked in one order would not resolve.
if(REFLUX_BOARD STREQUAL "host")
  add_library(reflux_hal_memory OBJECT hal/memory/memory_port.c hal/host/flash_model.c)
  target_include_directories(reflux_hal_memory PUBLIC hal/memory PRIVATE hal/host)
  target_link_libraries(reflux_hal_memory PUBLIC reflux_app reflux_hal PRIVATE reflux_options)

  add_executable(reflux-host hal/host/main.c hal/host/host_port.c hal/host/line.c hal/host/flash_model.c)
  target_link_libraries(reflux-host PRIVATE reflux_app reflux_hal reflux_options)
  set_target_properties(reflux-host PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
endif()

if(REFLUX_BOARD STREQUAL "stm32f405")
  set(port "${PROJECT_SOURCE_DIR}/hal/stm32f405")
  add_executable(reflux-stm32f405
    ${port}/main.c ${port}/startup.c ${port}/clock.c ${port}/uart.c ${port}/tick.c ${port}/nvm.c
    ${port}/watchdog.c ${port}/identity.c)
  target_link_libraries(reflux-stm32f405 PRIVATE reflux_app reflux_hal reflux_firmware_options)
  target_link_options(reflux-stm32f405 PRIVATE -nostartfiles -T${port}/stm32f405.ld -Wl,--gc-sections
    -Wl,--fatal-warnings -Wl,-Map=${CMAKE_BINARY_DIR}/reflux-stm32f405.map)
  set_target_properties(reflux-stm32f405 PROPERTIES SUFFIX ".elf" LINK_DEPENDS ${port}/stm32f405.ld
    RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
  add_custom_command(TARGET reflux-stm32f405 POST_BUILD
    COMMAND ${CMAKE_OBJCOPY} -O binary $<TARGET_FILE:reflux-stm32f405> ${CMAKE_BINARY_DIR}/reflux-stm32f405.bin
    COMMAND arm-none-eabi-size $<TARGET_FILE:reflux-stm32f405>)
endif()
