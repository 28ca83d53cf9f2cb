# The compact table of a column, made by the simulator's code and pasted into the whole firmware.
reflux_test(column_table LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_table.c
            LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
reflux_test(column_table_power LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_table_power.c
            LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
target_include_directories(test_column_table_power PRIVATE "${PROJECT_SOURCE_DIR}/hal/host")
# A block that names the table, of a kind that only the test has.
reflux_test(column_named LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_named.c
            LIBS reflux_hal_memory reflux_app reflux_every_kind reflux_link reflux_bench
                 reflux_plants)
