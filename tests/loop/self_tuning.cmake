# Self-tuning control (docs/methods/self-tuning.md) on the whole firmware with the pilot column.
set(folder "${CMAKE_CURRENT_LIST_DIR}/self_tuning")
foreach(part self_tuning self_tuning_without self_tuning_settings self_tuning_faults)
  reflux_test(${part} LABEL loop SOURCES ${folder}/test_${part}.c
              LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
  target_compile_definitions(test_${part} PRIVATE SELF_TUNING="${folder}")
endforeach()
