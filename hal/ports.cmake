# What puts a port under the firmware; included after the firmware's layers exist. Ports are object libraries:
# port and firmware call each other, which archives linked in one order would not resolve.
if(REFLUX_BOARD STREQUAL "host")
  add_library(reflux_hal_memory OBJECT hal/memory/memory_port.c hal/host/flash_model.c hal/host/process.c hal/host/buses.c)
  target_include_directories(reflux_hal_memory PUBLIC hal/memory hal/host PRIVATE host_sim)
  target_link_libraries(reflux_hal_memory PUBLIC reflux_app reflux_hal PRIVATE reflux_options)

  add_executable(reflux-host hal/host/main.c hal/host/host_port.c hal/host/line.c hal/host/hold.c hal/host/flash_model.c
    hal/host/process.c hal/host/buses.c)
  target_include_directories(reflux-host PRIVATE host_sim)
  target_link_libraries(reflux-host PRIVATE reflux_app reflux_hal reflux_options)
  set_target_properties(reflux-host PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
endif()

# What the STM32 ports have in common is in hal/stm32/; the port's own folder has clock, pins, flash and memory map.
if(REFLUX_BOARD MATCHES "^stm32")
  set(shared "${PROJECT_SOURCE_DIR}/hal/stm32")
  set(port "${PROJECT_SOURCE_DIR}/hal/${REFLUX_BOARD}")
  set(image "reflux-${REFLUX_BOARD}")
  find_program(PYTHON3 NAMES python3 REQUIRED)
  add_executable(${image}
    ${shared}/main.c ${shared}/startup.c ${shared}/uart.c ${shared}/tick.c ${shared}/watchdog.c ${shared}/identity.c
    ${shared}/memory.c ${shared}/image.c ${shared}/supply.c ${shared}/guard.c
    ${port}/clock.c ${port}/pins.c ${port}/nvm.c)
  if(REFLUX_HAS_WORKSPACE_BYTES)
    target_sources(${image} PRIVATE ${port}/workspace.c)
  endif()
  if(REFLUX_BOARD STREQUAL "stm32f405")
    target_sources(${image} PRIVATE ${port}/options.c ${port}/ram_test.c)
  endif()
  if(REFLUX_HAS_CONFIG_DEVICES)
    target_sources(${image} PRIVATE ${shared}/pin_map.c ${port}/pin_modes.c ${shared}/spi.c ${shared}/onewire.c ${port}/output.c)
    if(REFLUX_BOARD STREQUAL "stm32f405")
      target_sources(${image} PRIVATE ${port}/i2c.c ${port}/analog.c ${port}/pulse.c)
    else()
      target_sources(${image} PRIVATE ${port}/not_there.c)
    endif()
  endif()
  # Its loops are what memset and memcpy are made of, not calls of them.
  set_source_files_properties(${shared}/memory.c PROPERTIES COMPILE_OPTIONS
    "-fno-builtin;-fno-tree-loop-distribute-patterns")
  target_include_directories(${image} PRIVATE ${port} ${shared})
  target_link_libraries(${image} PRIVATE reflux_app reflux_hal reflux_firmware_options)
  target_link_options(${image} PRIVATE -nostartfiles -L${shared} -T${port}/${REFLUX_BOARD}.ld -Wl,--gc-sections -Wl,--sort-section=alignment
    -Wl,--fatal-warnings -Wl,-Map=${CMAKE_BINARY_DIR}/${image}.map)
  if(REFLUX_PINS)
    target_link_options(${image} PRIVATE -Wl,--defsym=stack_size=2192) # 208 bytes more: the board clock, and the interrupts of buses above it
  endif()
  set_target_properties(${image} PROPERTIES SUFFIX ".elf"
    LINK_DEPENDS "${port}/${REFLUX_BOARD}.ld;${shared}/sections.ld;${PROJECT_SOURCE_DIR}/tools/cmake/image_crc.py" RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
  add_custom_command(TARGET ${image} POST_BUILD
    COMMAND ${PYTHON3} ${PROJECT_SOURCE_DIR}/tools/cmake/image_crc.py ${CMAKE_OBJCOPY} $<TARGET_FILE:${image}>
            ${CMAKE_BINARY_DIR}/${image}.bin
    COMMAND arm-none-eabi-size $<TARGET_FILE:${image}>)
endif()
