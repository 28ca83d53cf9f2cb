# Entries of ctest: reflux_test() adds a Unity program, reflux_script_test() a Python script.
#
# Targets: `tests` builds the programs of every test. Tests in tests/run_once.txt cannot depend on the number format, so
# in a sanitized fixed-point build `tests` leaves them out and they carry the label `again`; `tests-again` builds them for
# the full tier.
add_custom_target(tests)
add_custom_target(tests-again)
file(STRINGS "${PROJECT_SOURCE_DIR}/tests/run_once.txt" REFLUX_RUN_ONCE REGEX "^[a-z]")
find_program(PYTHON3 NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH)
find_program(PYTHON3 NAMES python3)

# reflux_programs_of_test(NAME LABEL program ...): labels the ctest entry NAME and has its programs built.
function(reflux_programs_of_test name label)
  set(labels ${label})
  set(all tests)
  if(REFLUX_SANITIZE AND REFLUX_FIXED_POINT AND name IN_LIST REFLUX_RUN_ONCE)
    list(APPEND labels again)
    set(all tests-again)
  endif()
  if(ARGN)
    add_dependencies(${all} ${ARGN})
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" TIMEOUT ${REFLUX_HANG_S})
endfunction()

# reflux_test(NAME LABEL unit|loop SOURCES a.c ... LIBS reflux_x ...): one Unity program, one ctest entry.
function(reflux_test name)
  cmake_parse_arguments(arg "" "LABEL" "SOURCES;LIBS" ${ARGN})
  add_executable(test_${name} ${arg_SOURCES})
  target_link_libraries(test_${name} PRIVATE ${arg_LIBS} unity reflux_options m)
  target_include_directories(test_${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests/support")
  target_compile_options(test_${name} PRIVATE -Wno-missing-prototypes)
  if(REFLUX_SANITIZE)
    # A test's own source compiles five times faster without the optimiser; the firmware it links keeps -O1.
    target_compile_options(test_${name} PRIVATE -O0)
  endif()
  add_test(NAME ${name} COMMAND test_${name} WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}/tests")
  reflux_programs_of_test(${name} ${arg_LABEL} test_${name})
endfunction()

# reflux_script_test(NAME LABEL unit SCRIPT test_x.py [ARGUMENTS ...] [PROGRAMS target ...]): the script gets the path of
# each program, then the arguments.
function(reflux_script_test name)
  cmake_parse_arguments(arg "" "LABEL;SCRIPT" "ARGUMENTS;PROGRAMS" ${ARGN})
  set(paths)
  foreach(program ${arg_PROGRAMS})
    list(APPEND paths "$<TARGET_FILE:${program}>")
  endforeach()
  add_test(NAME ${name} COMMAND "${PYTHON3}" "${arg_SCRIPT}" ${paths} ${arg_ARGUMENTS})
  reflux_programs_of_test(${name} ${arg_LABEL} ${arg_PROGRAMS})
  set_tests_properties(${name} PROPERTIES ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1")
endfunction()
