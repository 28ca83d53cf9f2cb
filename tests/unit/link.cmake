# The plant link's codec, its document, and the bench that speaks it.
set(here "${CMAKE_CURRENT_LIST_DIR}")
set(support "${PROJECT_SOURCE_DIR}/tests/support")
set_source_files_properties("${here}/test_transport.c" "${here}/test_transport_serial.c"
  "${support}/test_controller_main.c"
  PROPERTIES COMPILE_DEFINITIONS _GNU_SOURCE) # pseudo-terminals

# The checksum with each size of its table, under names of their own.
foreach(entries 0 16 256)
  add_library(crc32_table_${entries} OBJECT "${PROJECT_SOURCE_DIR}/firmware/base/crc32.c")
  target_compile_definitions(crc32_table_${entries} PRIVATE CRC32_TABLE=${entries} crc32_update=crc32_table_${entries})
  target_link_libraries(crc32_table_${entries} PRIVATE reflux_base reflux_options)
  list(APPEND crc32_tables "$<TARGET_OBJECTS:crc32_table_${entries}>")
endforeach()
reflux_test(crc32 LABEL unit SOURCES "${here}/test_crc32.c" ${crc32_tables} LIBS reflux_options)
reflux_test(frame LABEL unit SOURCES "${here}/test_frame.c" LIBS reflux_link)
reflux_test(messages LABEL unit SOURCES "${here}/test_messages.c" LIBS reflux_link)
reflux_test(plant_link LABEL unit SOURCES "${here}/test_plant_link.c"
  LIBS reflux_hal_memory reflux_app reflux_link)
reflux_test(link_document LABEL unit SOURCES "${here}/test_link_document.c" LIBS reflux_link)

# A plant and a controller for tests of the bench alone.
add_library(bench_support STATIC "${support}/test_controller.c")
target_include_directories(bench_support PUBLIC "${support}")
target_link_libraries(bench_support PUBLIC reflux_bench PRIVATE reflux_options)
add_executable(test-controller "${support}/test_controller_main.c")
target_link_libraries(test-controller PRIVATE bench_support reflux_options)
add_executable(reflux-sim-two-by-two
  "${PROJECT_SOURCE_DIR}/host_sim/main.c" "${support}/two_by_two.c")
target_link_libraries(reflux-sim-two-by-two PRIVATE bench_support reflux_options)

reflux_test(instruments LABEL unit
  SOURCES "${here}/test_instruments.c" "${support}/two_by_two.c" LIBS bench_support)
reflux_test(scenario_input LABEL unit
  SOURCES "${here}/test_scenario_input.c" "${support}/two_by_two.c" LIBS bench_support)
reflux_test(link_server LABEL unit
  SOURCES "${here}/test_link_server.c" "${support}/two_by_two.c" LIBS bench_support)
reflux_test(transport LABEL unit SOURCES "${here}/test_transport.c" LIBS reflux_bench)
if(LIBSERIALPORT_FOUND)
  reflux_test(transport_serial LABEL unit
    SOURCES "${here}/test_transport_serial.c" LIBS reflux_bench ${CMAKE_DL_LIBS})
endif()

reflux_script_test(reflux_sim LABEL unit SCRIPT "${here}/test_reflux_sim.py" PROGRAMS reflux-sim-two-by-two test-controller
                   ARGUMENTS "${support}/python_plant.py")

# The firmware and a plant in one process, as libreflux_lab.so has them.
set(lab "${PROJECT_SOURCE_DIR}/tools/libreflux")
reflux_test(lab LABEL unit SOURCES "${here}/test_lab.c" "${lab}/lab.c" "${PROJECT_SOURCE_DIR}/host_sim/memory_transport.c"
  LIBS reflux_bench reflux_plants reflux_app reflux_hal_memory)
target_include_directories(test_lab PRIVATE "${lab}")
