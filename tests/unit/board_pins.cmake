# Settings of devices and outputs at the board's own pins, the host's buses, and the world that a wiring file makes of chips and loads.
foreach(part pins pins_check)
  reflux_test(${part} LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c" LIBS reflux_hal_memory reflux_app reflux_link)
endforeach()
