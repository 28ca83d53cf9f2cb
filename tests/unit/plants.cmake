# The column model in both scalar types (one source, two programs), its solver, and the plants.
reflux_test(column LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column.c LIBS reflux_model_double)
reflux_test(column_float LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column.c LIBS reflux_model)
reflux_test(column_ranges LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_ranges.c LIBS reflux_model)
foreach(part column_implicit column_transition column_truncated)
  reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_model_double m)
  reflux_test(${part}_float LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_model m)
endforeach()
reflux_test(column_config LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_config.c
            LIBS reflux_model_double)
reflux_test(column_solver LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_solver.c LIBS reflux_plants)
reflux_test(column_newton LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_newton.c LIBS reflux_plants)
reflux_test(column_holdup_points LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_holdup_points.c
            LIBS reflux_model_double)
reflux_test(column_holdup_points_float LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_holdup_points.c
            LIBS reflux_model)
reflux_test(column_holdups LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_holdups.c LIBS reflux_plants)
reflux_test(rosenbrock LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_rosenbrock.c LIBS reflux_plants)
reflux_test(column_balances LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_balances.c
            LIBS reflux_bench reflux_plants)
reflux_test(column_days LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_column_days.c LIBS reflux_bench reflux_plants)
reflux_test(input_jumps LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_input_jumps.c LIBS reflux_bench reflux_plants)
reflux_test(pilot LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_pilot.c LIBS reflux_bench reflux_plants)
reflux_test(splitter LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_splitter.c LIBS reflux_bench reflux_plants)
reflux_test(splitter_reference LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_splitter_reference.c
            LIBS reflux_bench reflux_plants)

reflux_test(derivative LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_derivative.c LIBS reflux_derivative)
reflux_test(cold_column LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_cold_column.c LIBS reflux_plants)
reflux_test(pilot_cold LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_pilot_cold.c LIBS reflux_bench reflux_plants)
reflux_test(pilot_cold_reference LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_pilot_cold_reference.c
            LIBS reflux_bench reflux_plants)

# Not a test: what a tick of a column costs.
add_executable(plant_cost "${PROJECT_SOURCE_DIR}/tests/bench/plant_cost.c")
target_link_libraries(plant_cost PRIVATE reflux_bench reflux_plants reflux_options m)

# Linear plants: files, exact steps, and the program around them.
reflux_test(linear_plants LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_linear_plants.c
            LIBS reflux_bench reflux_plants)
foreach(part linear_files linearise column_tasks column_files columns)
  reflux_script_test(${part} LABEL unit SCRIPT "${CMAKE_CURRENT_LIST_DIR}/test_${part}.py" PROGRAMS reflux-sim)
endforeach()

# The compact table of a column: made from a plant, read as the board reads it.
reflux_test(table_reading LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_table_reading.c
            LIBS reflux_bench reflux_plants reflux_table m)
target_compile_definitions(test_table_reading PRIVATE TABLE_DATA="${CMAKE_CURRENT_LIST_DIR}/data")

# Not a test: the simulator's own tables of plant files, for tools/reference.
add_executable(plant_tables "${PROJECT_SOURCE_DIR}/tests/support/plant_tables.c")
target_link_libraries(plant_tables PRIVATE reflux_bench reflux_plants reflux_options)
set_target_properties(plant_tables PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
