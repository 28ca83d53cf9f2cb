# The numeric heart: numbers, filters, tuning rules, PID, feedforward. Each in the number format of the preset.
reflux_test(base LABEL unit SOURCES test_base.c LIBS reflux_base)
reflux_test(num LABEL unit SOURCES test_num.c LIBS reflux_num)
reflux_test(ud LABEL unit SOURCES test_ud.c LIBS reflux_num)
reflux_test(signal LABEL unit SOURCES test_signal.c LIBS reflux_signal)
reflux_test(tuning LABEL unit SOURCES test_tuning.c LIBS reflux_design)
reflux_test(feedforward LABEL unit SOURCES test_feedforward.c LIBS reflux_feedforward)
foreach(part pid pid_settings pid_transfer pid_loop)
  reflux_test(${part} LABEL unit SOURCES test_${part}.c LIBS reflux_control)
endforeach()
foreach(part inferential inferential_changes inferential_cases inferential_vectors inferential_refused inferential_ends)
  reflux_test(${part} LABEL unit SOURCES test_${part}.c LIBS reflux_control)
endforeach()
# Their numbers as they were, in the float build.
if(NOT REFLUX_FIXED_POINT)
  reflux_test(control_numbers LABEL unit SOURCES test_control_numbers.c
              LIBS reflux_control reflux_compensate reflux_feedforward)
endif()

# Not a test: the tables behind the figures of docs/pid.md and docs/feedforward.md.
add_executable(pid_trace "${PROJECT_SOURCE_DIR}/tests/bench/pid_trace.c")
target_link_libraries(pid_trace PRIVATE reflux_control reflux_feedforward reflux_options m)
target_include_directories(pid_trace PRIVATE "${PROJECT_SOURCE_DIR}/tests/support")
reflux_test(ratio LABEL unit SOURCES test_ratio.c LIBS reflux_compensate m)
reflux_test(rst_kind LABEL unit SOURCES test_rst_kind.c LIBS reflux_control)
reflux_test(state_feedback LABEL unit SOURCES test_state_feedback.c LIBS reflux_control)
reflux_test(polynomial_kind LABEL unit SOURCES test_polynomial_kind.c LIBS reflux_compensate)
reflux_test(rls LABEL unit SOURCES test_rls.c LIBS reflux_identify)
reflux_test(rls_cases LABEL unit SOURCES test_rls_cases.c LIBS reflux_identify)
foreach(part gmv gmv_cases gmv_optimal gmv_cycle gmv_jammed gmv_trial gmv_supervise)
  reflux_test(${part} LABEL unit SOURCES test_${part}.c LIBS reflux_adapt)
endforeach()
reflux_test(plant_experiment LABEL unit SOURCES test_plant_experiment.c LIBS reflux_adapt)

# Not a test by itself: courses of a million samples (tools/campaign endurance).
set(endurance "${PROJECT_SOURCE_DIR}/tests/campaign/endurance")
add_executable(endurance ${endurance}/main.c ${endurance}/bare.c ${endurance}/plants.c ${endurance}/supervised.c)
target_link_libraries(endurance PRIVATE reflux_adapt reflux_options m)
target_include_directories(endurance PRIVATE "${PROJECT_SOURCE_DIR}/tests/support")
# A twentieth of it.
add_test(NAME endurance COMMAND endurance 50000)
set_tests_properties(endurance PROPERTIES LABELS unit)
