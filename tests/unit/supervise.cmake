# Supervision (modes, limits, plans) and settings.

reflux_test(event LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_event.c LIBS reflux_base)
reflux_test(job LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_job.c LIBS reflux_base)
reflux_test(workspace LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_workspace.c LIBS reflux_base)
foreach(part arena plan supervisor_modes supervisor_cascade supervisor_bumpless supervisor_decoupler supervisor_feedforward
             supervisor_constrain sequence sequence_faults sequence_rows supervisor_excite supervisor_retune supervisor_interlock supervisor_measurement supervisor_plan
             numbered numbered_compensators numbered_feedforwards numbered_polynomial applied_history block_excitation excitation_ends parameters text)
  if(EXISTS "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c")
    reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
                LIBS reflux_settings)
  endif()
endforeach()
target_link_libraries(test_numbered PRIVATE reflux_every_kind)
target_link_libraries(test_applied_history PRIVATE reflux_every_kind)
target_link_libraries(test_block_excitation PRIVATE reflux_every_kind)
target_link_libraries(test_excitation_ends PRIVATE reflux_every_kind)
foreach(part numbered_compensators numbered_feedforwards numbered_polynomial)
  target_link_libraries(test_${part} PRIVATE reflux_every_kind)
endforeach()

foreach(part analyser stand_in lost_estimate)
  reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_settings)
endforeach()
target_link_libraries(test_stand_in PRIVATE reflux_every_kind)
target_link_libraries(test_lost_estimate PRIVATE reflux_every_kind)

# Not a test: the instructions of a tick, for tools/bench.
add_executable(tick_cost "${PROJECT_SOURCE_DIR}/tests/bench/tick_cost.c")
target_link_libraries(tick_cost PRIVATE reflux_settings reflux_options)

# The rows of every kind: the product's, and those of the worked family.
reflux_test(kinds LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_kinds.c LIBS reflux_supervise)

# What stored sets say of the product's kinds.
reflux_test(block_parameter_ids LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_block_parameter_ids.c LIBS reflux_supervise)
