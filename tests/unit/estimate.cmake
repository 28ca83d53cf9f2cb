# Estimators: steps of the column's model towards what is measured, and the kind of block around them.
foreach(part composition composition_analysis composition_changes composition_events composition_refused composition_step covariance_ud)
  reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_estimate m)
endforeach()
