# Devices on the board's own buses: every devices/test_NAME.c is a program, and a test device_NAME. The bus follows a script.
file(GLOB sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_LIST_DIR}/devices/test_*.c")
foreach(source ${sources})
  get_filename_component(name "${source}" NAME_WE)
  string(REGEX REPLACE "^test_" "device_" name "${name}")
  reflux_test(${name} LABEL unit SOURCES "${source}" "${PROJECT_SOURCE_DIR}/tests/support/scripted_bus.c" LIBS reflux_devices)
endforeach()
