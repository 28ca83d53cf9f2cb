# Linear algebra, interaction analysis and the design of interacting loops: one source, two programs, float and double.
foreach(kind "" _double)
  foreach(part matrix real_trig ceigen polynomial)
    reflux_test(${part}${kind} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_num${kind})
  endforeach()
  foreach(part interact direction pairing candidates integrity structure ina ina_search)
    reflux_test(${part}${kind} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_interact${kind})
  endforeach()
  foreach(part loops shapes detune robust interact_extremes polynomial_decoupler state_decoupler state_poles pole_placement decoupler_shapes feedforward_rules
               response_fit refusal_reasons)
    reflux_test(${part}${kind} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_design${kind})
  endforeach()
endforeach()
reflux_test(ranges LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_ranges.c LIBS reflux_design)
reflux_test(interact_numbers LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_interact_numbers.c LIBS reflux_interact)
reflux_test(assignment LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_assignment.c LIBS reflux_interact)

# Settings on the plants themselves, by eigenvalues; and the library for the host tools.
if(TARGET libreflux)
  foreach(part detuned_loops state_tool)
    reflux_script_test(${part} LABEL tools SCRIPT "${CMAKE_CURRENT_LIST_DIR}/test_${part}.py" PROGRAMS libreflux)
  endforeach()
  foreach(part ina_tool decouple_tool)
    reflux_script_test(${part} LABEL tools SCRIPT "${CMAKE_CURRENT_LIST_DIR}/test_${part}.py" PROGRAMS libreflux reflux-host)
  endforeach()
endif()

# No tests: what the analysis of a 16 x 16 plant costs, and the search for settings of the worst member.
add_executable(interact_cost "${PROJECT_SOURCE_DIR}/tests/bench/interact_cost.c")
target_link_libraries(interact_cost PRIVATE reflux_design reflux_options m)
add_executable(robust_cost "${PROJECT_SOURCE_DIR}/tests/bench/robust_cost.c")
target_link_libraries(robust_cost PRIVATE reflux_design reflux_options m)
add_executable(matrix_cost "${PROJECT_SOURCE_DIR}/tests/bench/matrix_cost.c")
target_link_libraries(matrix_cost PRIVATE reflux_num reflux_options m)
