# Faults: in the instruments, in the readings, alarms, the watchdog's heartbeat.
reflux_test(faults LABEL unit
  SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_faults.c" "${PROJECT_SOURCE_DIR}/tests/support/two_by_two.c"
  LIBS bench_support)
foreach(part supervisor_faults alarms by_board)
  reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
              LIBS reflux_settings)
endforeach()
reflux_test(heartbeat LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_heartbeat.c
                                         ${PROJECT_SOURCE_DIR}/firmware/service/heartbeat.c)
target_include_directories(test_heartbeat PRIVATE "${REFLUX_LAYERS}/service")

# The host port's watchdog, around a firmware that hangs.
reflux_test(host_watchdog LABEL unit SOURCES
  "${CMAKE_CURRENT_LIST_DIR}/test_host_watchdog.c" "${PROJECT_SOURCE_DIR}/hal/host/host_port.c"
  "${PROJECT_SOURCE_DIR}/hal/host/line.c" "${PROJECT_SOURCE_DIR}/hal/host/hold.c" "${PROJECT_SOURCE_DIR}/hal/host/flash_model.c"
  "${PROJECT_SOURCE_DIR}/hal/host/process.c" "${PROJECT_SOURCE_DIR}/hal/host/buses.c" "${PROJECT_SOURCE_DIR}/firmware/service/heartbeat.c"
  LIBS reflux_hal)
target_include_directories(test_host_watchdog PRIVATE
  "${PROJECT_SOURCE_DIR}/hal/host" "${PROJECT_SOURCE_DIR}/host_sim" "${REFLUX_LAYERS}/app" "${REFLUX_LAYERS}/service")
set_source_files_properties("${CMAKE_CURRENT_LIST_DIR}/test_host_watchdog.c"
  PROPERTIES COMPILE_DEFINITIONS _GNU_SOURCE)
