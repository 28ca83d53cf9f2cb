# Firmware and link server in one process, with a line between them that damages what passes.
reflux_test(attack LABEL loop
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_attack.c ${PROJECT_SOURCE_DIR}/tests/support/two_by_two.c
  LIBS reflux_hal_memory reflux_app reflux_bench)
