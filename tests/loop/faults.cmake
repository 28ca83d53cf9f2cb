# Faults, alarms and restarts on the whole firmware.
foreach(part restart late_tick fault_matrix interlocks plan_changes)
  if(EXISTS "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c")
    reflux_test(${part} LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
                LIBS reflux_hal_memory reflux_app reflux_link)
  endif()
endforeach()
if(TARGET test_fault_matrix) # its plant stands behind the bench's instruments
  target_link_libraries(test_fault_matrix PRIVATE reflux_bench)
endif()

# ... of blocks with a number (blockN), with kinds that only the test has.
reflux_test(fault_matrix_blocks LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_fault_matrix_blocks.c
            LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_every_kind)
