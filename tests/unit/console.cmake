# Parts of the console that need no board.
reflux_test(line_editor LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_line_editor.c"
            "${PROJECT_SOURCE_DIR}/firmware/console/line_editor.c" LIBS reflux_base)
reflux_test(event_log LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_event_log.c"
            "${PROJECT_SOURCE_DIR}/firmware/service/event_log.c" "${PROJECT_SOURCE_DIR}/firmware/service/event_log_join.c"
            LIBS reflux_base)
reflux_test(flow LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_flow.c" LIBS reflux_hal)
target_include_directories(test_line_editor PRIVATE "${REFLUX_LAYERS}/console")
target_include_directories(test_event_log PRIVATE "${REFLUX_LAYERS}/service")

# The table of commands in docs/use/console.md, and whether it has all of them.
add_executable(command_table "${PROJECT_SOURCE_DIR}/tests/support/command_table.c")
target_link_libraries(command_table PRIVATE reflux_exchange reflux_options)
target_include_directories(command_table PRIVATE "${REFLUX_LAYERS}/console")
set_target_properties(command_table PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
add_test(NAME command_document COMMAND command_table "${PROJECT_SOURCE_DIR}/docs/use/console.md")
reflux_programs_of_test(command_document unit command_table)
