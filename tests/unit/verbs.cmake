# Verbs, events and proposals of blocks in the tick, with kinds that only these tests have.
foreach(part verbs block_events proposals)
  reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
              LIBS reflux_settings reflux_every_kind)
endforeach()
