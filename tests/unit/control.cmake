# The numeric heart: numbers, filters, tuning rules, PID, feedforward. Each in the number format of the preset.
reflux_test(assertion LABEL unit SOURCES test_assertion.c LIBS reflux_base)
reflux_test(base LABEL unit SOURCES test_base.c LIBS reflux_base)
reflux_test(num LABEL unit SOURCES test_num.c LIBS reflux_num)
reflux_test(ud LABEL unit SOURCES test_ud.c LIBS reflux_num)
reflux_test(signal LABEL unit SOURCES test_signal.c LIBS reflux_signal)
reflux_test(tuning LABEL unit SOURCES test_tuning.c LIBS reflux_design)

# Not a test: the tables behind the figures of docs/methods/pid.md and docs/methods/feedforward.md.
add_executable(pid_trace "${PROJECT_SOURCE_DIR}/tests/bench/pid_trace.c")
target_link_libraries(pid_trace PRIVATE reflux_every_kind reflux_options m)
target_include_directories(pid_trace PRIVATE "${PROJECT_SOURCE_DIR}/tests/support")
reflux_test(rls LABEL unit SOURCES test_rls.c LIBS reflux_identify)
reflux_test(rls_cases LABEL unit SOURCES test_rls_cases.c LIBS reflux_identify)

# Not a test by itself: courses of a million samples (tools/campaign endurance).
set(endurance "${PROJECT_SOURCE_DIR}/tests/campaign/endurance")
add_executable(endurance ${endurance}/main.c ${endurance}/bare.c ${endurance}/plants.c ${endurance}/supervised.c)
target_link_libraries(endurance PRIVATE reflux_every_kind reflux_options m)
target_include_directories(endurance PRIVATE "${PROJECT_SOURCE_DIR}/tests/support")
# A twentieth of it.
add_test(NAME endurance COMMAND endurance 50000)
reflux_programs_of_test(endurance unit endurance)

# Not a test by itself: weeks of the self-tuner beside its PI (tools/campaign self-tuner-weeks).
set(self_tuner "${PROJECT_SOURCE_DIR}/tests/campaign/self_tuner")
add_executable(self_tuner ${self_tuner}/main.c ${self_tuner}/run.c ${self_tuner}/sets.c ${self_tuner}/plants.c)
target_link_libraries(self_tuner PRIVATE reflux_every_kind reflux_options m)
target_include_directories(self_tuner PRIVATE "${PROJECT_SOURCE_DIR}/tests/support")
target_compile_options(self_tuner PRIVATE -O3)
# A sample of it.
add_test(NAME self_tuner COMMAND self_tuner grid 1 0 40 limits)
add_test(NAME self_tuner_rest COMMAND self_tuner noisy-rest 1 1 40 limits)
add_test(NAME self_tuner_named COMMAND self_tuner named 1 1 4 limits)
foreach(part self_tuner self_tuner_rest self_tuner_named)
  reflux_programs_of_test(${part} unit self_tuner)
endforeach()

# ... and the tuner of feedforward.
set(feedforward_tuner "${PROJECT_SOURCE_DIR}/tests/campaign/feedforward_tuner")
add_executable(feedforward_tuner ${feedforward_tuner}/main.c ${feedforward_tuner}/loop.c)
target_link_libraries(feedforward_tuner PRIVATE reflux_every_kind reflux_options m)
target_include_directories(feedforward_tuner PRIVATE "${PROJECT_SOURCE_DIR}/tests/support")
target_compile_options(feedforward_tuner PRIVATE -O3)
add_test(NAME feedforward_weeks COMMAND feedforward_tuner stays 21 1 3)
add_test(NAME feedforward_changes COMMAND feedforward_tuner change 21 1 5)
reflux_programs_of_test(feedforward_weeks unit feedforward_tuner)
reflux_programs_of_test(feedforward_changes unit feedforward_tuner)
