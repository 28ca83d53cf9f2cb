# Adaptive feedforward (docs/methods/adaptive-feedforward.md) on the whole firmware with Siddha's loop.
set(folder "${CMAKE_CURRENT_LIST_DIR}/feedforward")
foreach(part feedforward_tune feedforward_faults feedforward_speed feedforward_pilot
             feedforward_unlike feedforward_events feedforward_switch_off
             feedforward_term feedforward_time)
  reflux_test(${part} LABEL loop SOURCES ${folder}/test_${part}.c
              LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
  target_compile_definitions(test_${part} PRIVATE FEEDFORWARD="${folder}")
endforeach()
