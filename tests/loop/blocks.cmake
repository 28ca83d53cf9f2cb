# Verbs, events and proposals of blocks at the console, with kinds that only these tests have.
foreach(part block_verbs block_says block_proposals block_excites switch_offs)
  reflux_test(${part} LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
              LIBS reflux_hal_memory reflux_app reflux_every_kind reflux_link)
endforeach()
