# Identification, in both scalar types (one source, two programs).
foreach(part moments record fopdt_fit steady guard settling)
  reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_identify)
  reflux_test(${part}_double LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_identify_double)
endforeach()
