# Supervision (modes, limits, plans) and the parts of service that need no board.
reflux_test(decoupler LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_decoupler.c LIBS reflux_compensate)
reflux_test(event LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_event.c LIBS reflux_base)
reflux_test(job LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_job.c LIBS reflux_base)
reflux_test(workspace LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_workspace.c LIBS reflux_base)
foreach(part two_position arena plan supervisor_modes supervisor_cascade supervisor_bumpless supervisor_decoupler supervisor_feedforward
             supervisor_constrain sequence sequence_faults sequence_rows supervisor_excite supervisor_retune supervisor_interlock supervisor_measurement supervisor_plan
             served parameters text)
  if(EXISTS "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c")
    reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
                                           ${PROJECT_SOURCE_DIR}/firmware/service/parameters.c ${PROJECT_SOURCE_DIR}/firmware/service/parameter_find.c ${PROJECT_SOURCE_DIR}/firmware/service/parameter_set.c ${PROJECT_SOURCE_DIR}/firmware/service/block_parameters.c ${PROJECT_SOURCE_DIR}/firmware/service/words.c
                                           ${PROJECT_SOURCE_DIR}/firmware/service/parameter_table.c
                LIBS reflux_supervise)
    target_include_directories(test_${part} PRIVATE "${REFLUX_LAYERS}/service")
  endif()
endforeach()
target_link_libraries(test_two_position PRIVATE reflux_control)
target_link_libraries(test_served PRIVATE reflux_control)

# The table of parameters in docs/console.md, and whether it is current.
add_executable(parameter_table "${PROJECT_SOURCE_DIR}/tests/support/parameter_table.c"
               ${PROJECT_SOURCE_DIR}/firmware/service/parameters.c ${PROJECT_SOURCE_DIR}/firmware/service/parameter_find.c ${PROJECT_SOURCE_DIR}/firmware/service/parameter_set.c ${PROJECT_SOURCE_DIR}/firmware/service/block_parameters.c ${PROJECT_SOURCE_DIR}/firmware/service/words.c
               ${PROJECT_SOURCE_DIR}/firmware/service/parameter_table.c)
target_link_libraries(parameter_table PRIVATE reflux_supervise reflux_options)
target_include_directories(parameter_table PRIVATE "${REFLUX_LAYERS}/service")
set_target_properties(parameter_table PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
add_test(NAME parameter_document COMMAND parameter_table "${PROJECT_SOURCE_DIR}/docs/console.md")
set_tests_properties(parameter_document PROPERTIES LABELS unit TIMEOUT ${REFLUX_HANG_S})
