# Stored settings through the whole firmware and its console.
reflux_test(storage_session LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_storage_session.c
            LIBS reflux_hal_memory reflux_app reflux_link)
target_include_directories(test_storage_session PRIVATE "${PROJECT_SOURCE_DIR}/hal/host")
target_compile_definitions(test_storage_session PRIVATE
  STORAGE_IMAGES="${PROJECT_SOURCE_DIR}/tests/reference/storage")

# Settings of blocks at the console, with kinds that only the test has.
reflux_test(block_console LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_block_console.c
            LIBS reflux_hal_memory reflux_app reflux_every_kind reflux_link)
target_compile_definitions(test_block_console PRIVATE
  STORAGE_IMAGES="${PROJECT_SOURCE_DIR}/tests/reference/storage")
# What firmware before the Kalman filters stored of an estimator.
reflux_test(composition_stored LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_composition_stored.c
            LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
target_compile_definitions(test_composition_stored PRIVATE STORED_IMAGES="${PROJECT_SOURCE_DIR}/tests/reference/stored")
reflux_test(composition_dead_sensor LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_composition_dead_sensor.c
            LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
target_compile_definitions(test_composition_dead_sensor PRIVATE STORED_IMAGES="${PROJECT_SOURCE_DIR}/tests/reference/stored")
reflux_test(composition_return LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_composition_return.c
            LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
target_compile_definitions(test_composition_return PRIVATE STORED_IMAGES="${PROJECT_SOURCE_DIR}/tests/reference/stored")
