# Parts of the console that need no board.
reflux_test(line_editor LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_line_editor.c"
            "${PROJECT_SOURCE_DIR}/firmware/service/line_editor.c"
            "${PROJECT_SOURCE_DIR}/firmware/service/text.c"
            "${PROJECT_SOURCE_DIR}/firmware/service/decimal.c" LIBS reflux_base)
reflux_test(event_log LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_event_log.c"
            "${PROJECT_SOURCE_DIR}/firmware/service/event_log.c" LIBS reflux_base)
reflux_test(flow LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_flow.c" LIBS reflux_hal)
foreach(part line_editor event_log)
  target_include_directories(test_${part} PRIVATE "${REFLUX_LAYERS}/service")
endforeach()
