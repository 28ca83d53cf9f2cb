# Sequences on the whole firmware.
reflux_test(sequence_console LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_sequence_console.c
            LIBS reflux_hal_memory reflux_app reflux_link)
