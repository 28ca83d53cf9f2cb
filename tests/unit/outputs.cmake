# Outputs of the board, above pins that only remember.
foreach(part window burst burst_crossing switches stepper motor_valve dead_man enable ad5422)
  reflux_test(outputs_${part} LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/outputs/test_${part}.c"
              "${CMAKE_CURRENT_LIST_DIR}/outputs/outputs_bench.c" LIBS reflux_outputs)
endforeach()
foreach(part outputs output_check)
  reflux_test(${part} LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/outputs/test_${part}.c"
              "${CMAKE_CURRENT_LIST_DIR}/outputs/outputs_bench.c" LIBS reflux_outputs)
endforeach()
reflux_test(outputs_ad5422_chip LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/outputs/test_ad5422_chip.c"
            "${CMAKE_CURRENT_LIST_DIR}/outputs/outputs_bench.c" LIBS reflux_outputs reflux_chips)
