# Unity, the unit-test framework, from wherever it can be had; never copied into the repository.
#   1. UNITY_DIR given by the user: a folder with unity.c, unity.h, unity_internals.h (or src/ of a checkout)
#   2. the Debian source package ntpsec, folder tests/unity (Unity 2.5.1, MIT), by apt-get source
#   3. the upstream release, by FetchContent with a pinned hash
set(UNITY_DIR "" CACHE PATH "Folder that holds unity.c and unity.h")

function(reflux_find_unity result)
  foreach(folder "${UNITY_DIR}" "${UNITY_DIR}/src" "${PROJECT_SOURCE_DIR}/build/unity")
    if(EXISTS "${folder}/unity.c" AND EXISTS "${folder}/unity.h")
      set(${result} "${folder}" PARENT_SCOPE)
      return()
    endif()
  endforeach()
  if(UNITY_DIR)
    message(FATAL_ERROR "UNITY_DIR=${UNITY_DIR} has no unity.c and unity.h (nor has its src folder)")
  endif()
  message(STATUS "Unity: fetching the Debian source package ntpsec, which carries it")
  execute_process(COMMAND "${PROJECT_SOURCE_DIR}/tools/fetch-unity" "${PROJECT_SOURCE_DIR}/build/unity"
                  RESULT_VARIABLE failed)
  if(NOT failed)
    set(${result} "${PROJECT_SOURCE_DIR}/build/unity" PARENT_SCOPE)
    return()
  endif()
  message(STATUS "Unity: fetching the upstream release")
  include(FetchContent)
  FetchContent_Declare(unity_upstream
    URL https://github.com/ThrowTheSwitch/Unity/archive/refs/tags/v2.5.2.tar.gz
    URL_HASH SHA256=3786de6c8f389be3894feae4f7d8680a02e70ed4dbcce36109c8f8646da2671a)
  FetchContent_Populate(unity_upstream)
  set(${result} "${unity_upstream_SOURCE_DIR}/src" PARENT_SCOPE)
endfunction()

reflux_find_unity(unity_folder)
message(STATUS "Unity: ${unity_folder}")
add_library(unity STATIC "${unity_folder}/unity.c")
target_include_directories(unity SYSTEM PUBLIC "${unity_folder}")
if(REFLUX_SANITIZE)
  target_compile_options(unity PRIVATE -fsanitize=address,undefined)
endif()
target_compile_definitions(unity PUBLIC UNITY_INCLUDE_DOUBLE)
