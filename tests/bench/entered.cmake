# Adds the program `entered` to this version of the repository or to another: tests/bench/entered.py configures it with
# -DCMAKE_PROJECT_reflux_INCLUDE=this file.
function(reflux_entered)
  add_executable(entered EXCLUDE_FROM_ALL "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/entered.c")
  target_include_directories(entered PRIVATE "${PROJECT_SOURCE_DIR}/tests/support")
  target_link_libraries(entered PRIVATE reflux_hal_memory reflux_app reflux_link unity)
  target_link_options(entered PRIVATE -no-pie)
  set_target_properties(entered PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
endfunction()
cmake_language(DEFER CALL reflux_entered)
