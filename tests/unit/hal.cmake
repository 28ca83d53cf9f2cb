# The ports that run on the host, each around a firmware that only records what reaches it.
foreach(port memory host)
  reflux_test(hal_${port} LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_hal_${port}.c" LIBS reflux_hal)
  target_include_directories(test_hal_${port} PRIVATE
    "${PROJECT_SOURCE_DIR}/hal/memory" "${PROJECT_SOURCE_DIR}/hal/host" "${PROJECT_SOURCE_DIR}/host_sim" "${REFLUX_LAYERS}/app")
  target_sources(test_hal_${port} PRIVATE "${PROJECT_SOURCE_DIR}/hal/host/flash_model.c"
    "${PROJECT_SOURCE_DIR}/hal/host/process.c" "${PROJECT_SOURCE_DIR}/hal/host/buses.c")
endforeach()
target_sources(test_hal_memory PRIVATE "${PROJECT_SOURCE_DIR}/hal/memory/memory_port.c")
target_sources(test_hal_host PRIVATE
  "${PROJECT_SOURCE_DIR}/hal/host/host_port.c" "${PROJECT_SOURCE_DIR}/hal/host/line.c"
  "${PROJECT_SOURCE_DIR}/hal/host/hold.c")
set_source_files_properties("${CMAKE_CURRENT_LIST_DIR}/test_hal_host.c"
  PROPERTIES COMPILE_DEFINITIONS _GNU_SOURCE)

# Drivers of a chip, on plain memory in place of its registers: they take addresses for 32 bits.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  reflux_test(stm32_flash LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_stm32_flash.c"
    "${PROJECT_SOURCE_DIR}/hal/stm32f405/nvm.c" "${PROJECT_SOURCE_DIR}/hal/stm32/watchdog.c" LIBS reflux_hal)
  target_include_directories(test_stm32_flash PRIVATE
    "${PROJECT_SOURCE_DIR}/hal/stm32" "${PROJECT_SOURCE_DIR}/hal/stm32f405")
  target_include_directories(test_stm32_flash PRIVATE "${REFLUX_LAYERS}/app")
  target_compile_options(test_stm32_flash PRIVATE -Wno-int-to-pointer-cast -D_GNU_SOURCE
    "SHELL:-include ${PROJECT_SOURCE_DIR}/tests/support/stm32_on_host.h")
  # Start, clocks, supply and faults of each chip, on a model of its registers; clock.c is part of the test's own file.
  foreach(chip stm32f405 stm32f100)
    set(shared "${PROJECT_SOURCE_DIR}/hal/stm32")
    set(port "${PROJECT_SOURCE_DIR}/hal/${chip}")
    reflux_test(${chip}_chip LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_stm32_chip.c"
      "${CMAKE_CURRENT_LIST_DIR}/stm32_release_pins.c" "${port}/pins.c" "${port}/nvm.c" "${shared}/identity.c"
      "${shared}/supply.c" "${shared}/guard.c" "${shared}/watchdog.c" LIBS reflux_hal)
    if(EXISTS "${port}/options.c")
      target_sources(test_${chip}_chip PRIVATE "${port}/options.c")
    endif()
    # What start-up leaves in the registers.
    reflux_test(${chip}_start LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_stm32_start.c" "${port}/pins.c"
      "${shared}/identity.c" "${shared}/supply.c" "${shared}/uart.c" "${shared}/tick.c" "${shared}/watchdog.c" LIBS reflux_hal)
    foreach(about chip start)
      target_include_directories(test_${chip}_${about} PRIVATE "${port}" "${shared}" "${REFLUX_LAYERS}/app")
      target_compile_options(test_${chip}_${about} PRIVATE -UNDEBUG -Wno-int-to-pointer-cast
        "SHELL:-include ${PROJECT_SOURCE_DIR}/tests/support/stm32_model.h")
    endforeach()
  endforeach()
endif()

reflux_test(stm32_memory LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_stm32_memory.c"
  "${PROJECT_SOURCE_DIR}/hal/stm32/memory.c")
set_source_files_properties("${PROJECT_SOURCE_DIR}/hal/stm32/memory.c" PROPERTIES COMPILE_OPTIONS
  "-fno-builtin;-Dmemset=by_words_memset;-Dmemcpy=by_words_memcpy")

reflux_script_test(reflux_host LABEL unit SCRIPT "${CMAKE_CURRENT_LIST_DIR}/test_reflux_host.py" PROGRAMS reflux-host)
