# Adds tick_cost to another version of this repository, whose own files stay as they are: tools/bench --before COMMIT configures
# that version with -DCMAKE_PROJECT_reflux_INCLUDE=this file.
function(reflux_tick_cost)
  # Of settings; older versions have them in service.
  file(GLOB sources "${PROJECT_SOURCE_DIR}/firmware/settings/*.c" "${PROJECT_SOURCE_DIR}/firmware/service/parameter*.c"
       "${PROJECT_SOURCE_DIR}/firmware/service/block_parameters.c" "${PROJECT_SOURCE_DIR}/firmware/service/words.c")
  add_executable(tick_cost_beside EXCLUDE_FROM_ALL "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/tick_cost.c" ${sources})
  file(STRINGS "${PROJECT_SOURCE_DIR}/firmware/supervise/supervisor.h" before REGEX "supervisor_bind_output")
  if(before) # the names it has for manipulated variables
    target_compile_definitions(tick_cost_beside PRIVATE BEFORE_MV_STATE)
  endif()
  target_link_libraries(tick_cost_beside PRIVATE reflux_supervise reflux_firmware_options)
  target_include_directories(tick_cost_beside PRIVATE "${REFLUX_LAYERS}/service" "${REFLUX_LAYERS}/settings")
  set_target_properties(tick_cost_beside PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
endfunction()
cmake_language(DEFER CALL reflux_tick_cost)
