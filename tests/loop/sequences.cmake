# Sequences on the whole firmware.
reflux_test(sequence_console LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_sequence_console.c
            LIBS reflux_hal_memory reflux_app reflux_link)

# ... with the cold pilot column behind the bench's instruments.
reflux_test(cold_start LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_cold_start.c
            LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
reflux_test(sequence_matrix LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_sequence_matrix.c
            LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
