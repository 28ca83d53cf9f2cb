# Faults of a virtual board's hardware.
if(TARGET reflux_virtual_board)
  reflux_test(board_faults LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_board_faults.c LIBS reflux_virtual_board)
endif()
