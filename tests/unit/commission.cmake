# Automatic start-up, below the console.
foreach(part experiment combine model_cases relay_numbers origin model analysis analysis_structure certainty swing
             limits progress verdict analysis_choice analysis_crossover sensor_watch)
  reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_commission)
endforeach()
foreach(part proposal proposal_structure adoption adoption_bounds next_test startup_direction outcome commission_requests by_relay
             commission_blocking trial_steps analysis_job adoption_rest adoption_probe kept_watch)
  if(EXISTS "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c")
    reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
                LIBS reflux_settings reflux_commission)
  endif()
endforeach()
