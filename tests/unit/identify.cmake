# Identification, in both scalar types (one source, two programs).
foreach(kind "" _double)
  reflux_test(difference_model${kind} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_difference_model.c LIBS reflux_lti${kind})
endforeach()
foreach(part prbs triangle arx arx_select decimate moments record fopdt_fit fit_bend shape_response shape_fit shape_found steady guard settling relay ranges_identify)
  reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_identify)
  reflux_test(${part}_double LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_identify_double)
endforeach()
foreach(part fit_cases identify_cases arx_rls high_order high_order_confidence disturbance_ratio)
  reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_identify)
endforeach()

# Not a test: identifies the records of tools/figures/identification_table.py.
add_executable(identify_records "${PROJECT_SOURCE_DIR}/tests/bench/identify_records.c")
target_link_libraries(identify_records PRIVATE reflux_identify reflux_options m)
add_test(NAME identification_noise COMMAND "${PYTHON3}" "${PROJECT_SOURCE_DIR}/tools/figures/identification_table.py"
  --program $<TARGET_FILE:identify_records> --seeds 10 --check)
reflux_programs_of_test(identification_noise unit identify_records)
set_tests_properties(identification_noise PROPERTIES ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1")

# Not a test either: fits shapes to the records of tests/bench/shape_deviations.py.
add_executable(shape_records "${PROJECT_SOURCE_DIR}/tests/bench/shape_records.c")
target_link_libraries(shape_records PRIVATE reflux_identify reflux_options m)
add_test(NAME shape_deviations COMMAND "${PYTHON3}" "${PROJECT_SOURCE_DIR}/tests/bench/shape_deviations.py"
  --program $<TARGET_FILE:shape_records> --draws 30 --check)
reflux_programs_of_test(shape_deviations unit shape_records)
set_tests_properties(shape_deviations PROPERTIES ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1")

# Through the library for the host tools, and tools/identify.
if(TARGET libreflux)
  reflux_script_test(identification_library LABEL tools SCRIPT "${CMAKE_CURRENT_LIST_DIR}/test_identification.py" PROGRAMS libreflux)
endif()
