# The whole firmware on the board in memory: console, plant link, restart.
foreach(part acting_loops belief derived_channels calibration repeats sensor_mistakes analyser_console session standstill odd_plant interrupted plant_mismatch console console_fuzz telemetry safe_start)
  if(EXISTS "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c")
    reflux_test(${part} LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
                LIBS reflux_hal_memory reflux_app reflux_link)
  endif()
endforeach()
reflux_test(interrupted_blocks LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_interrupted_blocks.c
            LIBS reflux_hal_memory reflux_app reflux_link)
target_compile_definitions(test_interrupted_blocks PRIVATE SCENARIOS="${PROJECT_SOURCE_DIR}/host_sim/scenarios"
                           DECOUPLING="${CMAKE_CURRENT_LIST_DIR}/decoupling" FEEDFORWARD="${CMAKE_CURRENT_LIST_DIR}/feedforward")

# The plant at the board's own pins, with models of chips.
foreach(part board_pins board_pins_kinds board_anew both_sources derived_pins board_proof wired_inputs)
  reflux_test(${part} LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_hal_memory reflux_app reflux_link reflux_chips)
endforeach()
# Proofs of outputs on a plant of the bench, without the firmware around them.
reflux_test(output_proof_plants LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_output_proof_plants.c LIBS reflux_io reflux_bench reflux_plants)
