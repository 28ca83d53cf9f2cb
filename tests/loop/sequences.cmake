# Sequences on the whole firmware.
reflux_test(sequence_console LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_sequence_console.c
            LIBS reflux_hal_memory reflux_app reflux_link)

# ... with the cold pilot column behind the bench's instruments.
foreach(part cold_start sequence_matrix)
  if(EXISTS "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c")
    reflux_test(${part} LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
                LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
  endif()
endforeach()
