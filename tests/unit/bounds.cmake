# Frame decoder, rings and queues: everything they can meet.
reflux_test(bounds LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_bounds.c" LIBS reflux_link reflux_hal)
