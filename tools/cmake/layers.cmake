# A layer is a folder under firmware/ (or the contract headers of hal/) built as one target that sees only
# the layers it names. Each layer gets an include root of its own holding one link, so that
# #include "supervise/blocks.h" in a lower layer finds nothing and does not compile.
#
# The links stand in the build tree, or wherever REFLUX_LAYERS says: two trees that see the same headers under the same
# paths make the same machine code from the same text (sanitizers write paths into programs), and tools/test runs it once.
set(REFLUX_LAYERS "${CMAKE_BINARY_DIR}/layers" CACHE PATH "Folder of the layers' include roots")

# name: as it stands in #include, like base or kinds/pid
function(reflux_include_root name folder result)
  string(REPLACE "/" "_" place "${name}")
  set(root "${REFLUX_LAYERS}/${place}")
  get_filename_component(above "${root}/${name}" DIRECTORY)
  file(MAKE_DIRECTORY "${above}")
  # Trees that share the links may be configured at the same time, so a link that is right stays untouched.
  set(found "")
  if(IS_SYMLINK "${root}/${name}")
    file(READ_SYMLINK "${root}/${name}" found)
  endif()
  if(NOT found STREQUAL folder)
    file(CREATE_LINK "${folder}" "${root}/${name}" SYMBOLIC)
  endif()
  set(${result} "${root}" PARENT_SCOPE)
endfunction()

# What the board has of these, as its limits and the headers say: REFLUX_HAS_... A layer names the sources that a board without it lacks
# behind the name.
set(REFLUX_PARTS CONFIG_ANALYSERS CONFIG_BLOCKS CONFIG_CALIBRATION CONFIG_DEVICES CONFIG_EXPERIMENT CONFIG_FEEDFORWARD_TUNE CONFIG_LINK CONFIG_PEOPLE CONFIG_STEPS CONFIG_LOOP_GUARD COMMISSION_CHANNELS EVENT_LOG_JOINS JOBS_MAX
  DEVICE_ALL_KINDS OUTPUT_ALL_KINDS REFLUX_ASSERTIONS WORKSPACE_BYTES)
set(probe "#include \"exchange/config.h\"\n")
foreach(header base/job.h base/workspace.h devices/devices.h service/event_log.h kinds/experiment/plant_experiment.h kinds/ff_tune/feedforward_tune.h)
  if(EXISTS "${PROJECT_SOURCE_DIR}/firmware/${header}")
    string(APPEND probe "#include \"${header}\"\n")
  endif()
endforeach()
foreach(part ${REFLUX_PARTS})
  string(APPEND probe "#if ${part}\nreflux_has_${part}\n#endif\n")
endforeach()
file(WRITE "${CMAKE_BINARY_DIR}/parts.c" "${probe}")
set(before)
if(EXISTS "${limits}") # tools/cmake/options.cmake
  set(before -include "${limits}")
endif()
if(REFLUX_ASSERTIONS)
  list(APPEND before -DREFLUX_ASSERTIONS=1)
endif()
separate_arguments(flags UNIX_COMMAND "${CMAKE_C_FLAGS}")
execute_process(COMMAND "${CMAKE_C_COMPILER}" ${flags} -E -P ${before} "-I${PROJECT_SOURCE_DIR}/firmware" "-I${PROJECT_SOURCE_DIR}" "${CMAKE_BINARY_DIR}/parts.c"
  OUTPUT_VARIABLE parts RESULT_VARIABLE status ERROR_VARIABLE said)
if(status)
  message(FATAL_ERROR "The parts of this board are not known: ${said}")
endif()
foreach(part ${REFLUX_PARTS})
  set(REFLUX_HAS_${part} OFF)
  if(parts MATCHES "reflux_has_${part}")
    set(REFLUX_HAS_${part} ON)
  endif()
endforeach()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${limits}" "${PROJECT_SOURCE_DIR}/firmware/exchange/config.h"
  "${PROJECT_SOURCE_DIR}/firmware/block/settings.h")

# reflux_layer(NAME [SOURCES a.c ...] [CONFIG_BLOCKS b.c ...] ... [WITHOUT_BLOCKS c.c ...] [DEPENDS base num ...])
# Target reflux_NAME; without sources it is header-only.
function(reflux_layer name)
  cmake_parse_arguments(arg "" "INCLUDED_AS" "SOURCES;DEPENDS;WITHOUT_BLOCKS;${REFLUX_PARTS}" ${ARGN})
  if(NOT REFLUX_HAS_CONFIG_BLOCKS)
    list(APPEND arg_SOURCES ${arg_WITHOUT_BLOCKS})
  endif()
  foreach(part ${REFLUX_PARTS})
    if(REFLUX_HAS_${part})
      list(APPEND arg_SOURCES ${arg_${part}})
    endif()
  endforeach()
  if(NOT arg_INCLUDED_AS)
    set(arg_INCLUDED_AS ${name})
  endif()
  reflux_include_root(${arg_INCLUDED_AS} "${CMAKE_CURRENT_SOURCE_DIR}" root)
  list(TRANSFORM arg_DEPENDS PREPEND reflux_ OUTPUT_VARIABLE below)
  if(arg_SOURCES)
    add_library(reflux_${name} STATIC ${arg_SOURCES})
    target_include_directories(reflux_${name} PUBLIC "${root}")
    target_link_libraries(reflux_${name} PUBLIC ${below} PRIVATE reflux_firmware_options)
  else()
    add_library(reflux_${name} INTERFACE)
    target_include_directories(reflux_${name} INTERFACE "${root}")
    target_link_libraries(reflux_${name} INTERFACE ${below})
  endif()
endfunction()

# reflux_kind(NAME SOURCES a.c ... DEPENDS block ...): a family of blocks in kinds/NAME. Target reflux_NAME; header-only on a board
# that has its headers only (firmware/kinds/CMakeLists.txt).
function(reflux_kind name)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPENDS" ${ARGN})
  if(NOT name IN_LIST here)
    set(arg_SOURCES)
  endif()
  reflux_layer(${name} INCLUDED_AS kinds/${name} SOURCES ${arg_SOURCES} DEPENDS ${arg_DEPENDS})
  set_property(GLOBAL APPEND PROPERTY REFLUX_KINDS reflux_${name})
endfunction()

# The same sources once more with another real_t, defined by what; host only. Target reflux_NAME_SUFFIX.
function(reflux_layer_again name suffix what)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPENDS" ${ARGN})
  if(NOT REFLUX_BOARD STREQUAL "host")
    return()
  endif()
  set(target reflux_${name}_${suffix})
  add_library(${target} STATIC ${arg_SOURCES})
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON) # they go into libreflux.so
  target_include_directories(${target} PUBLIC "${REFLUX_LAYERS}/${name}")
  target_compile_definitions(${target} PUBLIC ${what}=1)
  list(TRANSFORM arg_DEPENDS PREPEND reflux_ OUTPUT_VARIABLE below)
  target_link_libraries(${target} PUBLIC ${below} m PRIVATE reflux_options)
endfunction()

# reflux_double_layer(NAME SOURCES a.c ...): real_t = double, for the simulator and the host tools. Target
# reflux_NAME_double.
function(reflux_double_layer name)
  reflux_layer_again(${name} double REFLUX_REAL_DOUBLE ${ARGN})
endfunction()

# reflux_long_layer(NAME SOURCES a.c ...): real_t = long double, for derivatives by differences. Target reflux_NAME_long.
function(reflux_long_layer name)
  reflux_layer_again(${name} long REFLUX_REAL_LONG ${ARGN})
endfunction()
