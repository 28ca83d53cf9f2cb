# Decoupling (docs/methods/polynomial-decoupler.md) on the whole firmware with Kotyk and Machacek's column.
set(folder "${CMAKE_CURRENT_LIST_DIR}/decoupling")
foreach(part decoupling_faults decoupling_experiment experiment_faults experiment_unknown state_faults state_law_loop state_law_model ahead_faults
             leadlag_faults design_faults)
  reflux_test(${part} LABEL loop SOURCES ${folder}/test_${part}.c
              LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
  target_compile_definitions(test_${part} PRIVATE DECOUPLING="${folder}" SCENARIOS="${PROJECT_SOURCE_DIR}/host_sim/scenarios")
endforeach()
reflux_test(experiment_decoupled LABEL loop SOURCES ${folder}/test_experiment_decoupled.c
            LIBS reflux_design_double reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
target_compile_definitions(test_experiment_decoupled PRIVATE DECOUPLING="${folder}" SCENARIOS="${PROJECT_SOURCE_DIR}/host_sim/scenarios"
                           PAGE="${PROJECT_SOURCE_DIR}/docs/methods/experiment.md")
