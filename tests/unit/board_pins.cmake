# Settings of devices and outputs at the board's own pins, the host's buses, and the world that a wiring file makes of chips and loads.
foreach(part pins pins_check output_proof output_proof_pots)
  reflux_test(${part} LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c" LIBS reflux_hal_memory reflux_app reflux_link)
endforeach()
foreach(part wired wired_driven)
  reflux_test(${part} LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c" LIBS reflux_chips)
endforeach()
reflux_test(board_io LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_board_io.c" LIBS reflux_hal_memory reflux_app reflux_link reflux_chips)
foreach(part host_buses host_inputs)
  reflux_test(${part} LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c" "${PROJECT_SOURCE_DIR}/hal/host/buses.c"
              LIBS reflux_chips reflux_hal)
  target_include_directories(test_${part} PRIVATE "${PROJECT_SOURCE_DIR}/hal/host")
endforeach()
