# The compact table of a column, made by the simulator's code and pasted into the whole firmware.
reflux_test(column_table LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_table.c
            LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
