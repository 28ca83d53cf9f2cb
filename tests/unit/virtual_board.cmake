# Models of the virtual board, asked register by register.
if(TARGET reflux_virtual_board)
  reflux_test(virtual_board_f1 LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_virtual_board_f1.c" LIBS reflux_virtual_board)
  target_include_directories(test_virtual_board_f1 PRIVATE
    "${PROJECT_SOURCE_DIR}/hal/stm32" "${PROJECT_SOURCE_DIR}/hal/stm32f100")
  reflux_test(virtual_board_guard LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_virtual_board_guard.c" LIBS reflux_virtual_board)
  target_include_directories(test_virtual_board_guard PRIVATE
    "${PROJECT_SOURCE_DIR}/hal/stm32" "${PROJECT_SOURCE_DIR}/hal/stm32f405")
endif()
