# Linear algebra, interaction analysis and the design of interacting loops: one source, two programs each, float and double.
foreach(part matrix real_trig)
  foreach(kind "" _double)
    reflux_test(${part}${kind} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_num${kind})
  endforeach()
endforeach()
