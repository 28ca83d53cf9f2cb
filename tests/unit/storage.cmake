# Parameter storage: format and old images, other versions, and power cut everywhere. The two plans of the service.
foreach(part storage storage_versions storage_power storage_unstable service_plans)
  reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
              LIBS reflux_hal_memory reflux_app reflux_link)
  target_include_directories(test_${part} PRIVATE "${PROJECT_SOURCE_DIR}/hal/host")
  target_compile_definitions(test_${part} PRIVATE
    STORAGE_IMAGES="${PROJECT_SOURCE_DIR}/tests/reference/storage")
endforeach()

# Settings of blocks, with kinds that only the test has.
foreach(part block_settings block_stored storage_power_blocks storage_unstable_blocks)
  string(REPLACE unstable_blocks unstable source test_${part}.c)
  reflux_test(${part} LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/${source}
              LIBS reflux_hal_memory reflux_app reflux_every_kind reflux_link)
  target_include_directories(test_${part} PRIVATE "${PROJECT_SOURCE_DIR}/hal/host")
  target_compile_definitions(test_${part} PRIVATE
    STORAGE_IMAGES="${PROJECT_SOURCE_DIR}/tests/reference/storage")
endforeach()
target_compile_definitions(test_storage_unstable_blocks PRIVATE WITH_BLOCKS)

# The old images are what the script of the documented format writes.
reflux_script_test(storage_images LABEL unit SCRIPT "${CMAKE_CURRENT_LIST_DIR}/test_storage_images.py")

# Tables, which stand in RAM once.
reflux_test(tables LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_tables.c
            LIBS reflux_hal_memory reflux_app reflux_every_kind reflux_link)
target_include_directories(test_tables PRIVATE "${PROJECT_SOURCE_DIR}/hal/host")
