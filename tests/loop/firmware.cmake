# The whole firmware on the board in memory: console, plant link, restart.
foreach(part analyser_console session standstill odd_plant interrupted told console console_fuzz telemetry safe_start)
  if(EXISTS "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c")
    reflux_test(${part} LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
                LIBS reflux_hal_memory reflux_app reflux_link)
  endif()
endforeach()
