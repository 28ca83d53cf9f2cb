# Automatic start-up on the whole firmware, with linear plants behind the bench's instruments.
foreach(part people faults phases trial table listings numbers relay)
  reflux_test(commission_${part} LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_commission_${part}.c
              LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
endforeach()
# Every listing, beside tests/reference/listings.txt.
reflux_test(transcript LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_transcript.c
            LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
# What a sample waits for, and what large memory is leased for.
foreach(part jobs workspace_lease)
  reflux_test(${part} LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
              LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
endforeach()
# A client without text, beside the console. It sees the firmware's headers, the plant those of the bench.
add_library(plant_side STATIC EXCLUDE_FROM_ALL "${PROJECT_SOURCE_DIR}/tests/support/plant_side.c")
target_link_libraries(plant_side PRIVATE reflux_hal_memory reflux_link reflux_bench reflux_plants unity reflux_options)
target_include_directories(plant_side PUBLIC "${PROJECT_SOURCE_DIR}/tests/support")
foreach(part client clients)
  reflux_test(${part} LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
              LIBS plant_side reflux_hal_memory reflux_app reflux_link)
endforeach()
# A Kalman filter whose covariance stands in the same large memory.
reflux_test(composition_lease LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_composition_lease.c
            LIBS reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
target_compile_definitions(test_composition_lease PRIVATE PILOT_KALMAN_CONF="${PROJECT_SOURCE_DIR}/host_sim/scenarios/pilot-kalman.conf")
