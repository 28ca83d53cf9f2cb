# Automatic start-up, below the console.
foreach(part experiment model analysis proposal adoption)
  if(EXISTS "${CMAKE_CURRENT_LIST_DIR}/test_${part}.c")
    reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c LIBS reflux_commission)
  endif()
endforeach()
