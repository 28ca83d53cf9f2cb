# Parts of the console that need no board.
reflux_test(line_editor LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_line_editor.c"
            "${PROJECT_SOURCE_DIR}/firmware/console/line_editor.c" LIBS reflux_base)
reflux_test(event_log LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_event_log.c"
            "${PROJECT_SOURCE_DIR}/firmware/service/event_log.c" "${PROJECT_SOURCE_DIR}/firmware/service/event_log_join.c"
            LIBS reflux_base)
reflux_test(flow LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_flow.c" LIBS reflux_hal)
target_include_directories(test_line_editor PRIVATE "${REFLUX_LAYERS}/console")
target_include_directories(test_event_log PRIVATE "${REFLUX_LAYERS}/service")

# Not a test: the firmware's own tables, for tools/reference.
add_executable(reference_tables "${PROJECT_SOURCE_DIR}/tests/support/reference_tables.c")
target_link_libraries(reference_tables PRIVATE reflux_app reflux_hal_memory reflux_options)
add_executable(pin_tables "${PROJECT_SOURCE_DIR}/tests/support/pin_tables.c")
target_link_libraries(pin_tables PRIVATE reflux_app reflux_hal_memory reflux_chips reflux_devices reflux_outputs reflux_options)
set_target_properties(pin_tables PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
set_target_properties(reference_tables PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
