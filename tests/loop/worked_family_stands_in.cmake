# The observer of the worked family as fall-back of a measurement.
set(folder "${CMAKE_CURRENT_LIST_DIR}/worked_family")
reflux_test(stands_in LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_stands_in.c
            LIBS worked_family reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
target_include_directories(test_stands_in PRIVATE "${CMAKE_CURRENT_LIST_DIR}")
target_compile_definitions(test_stands_in PRIVATE WORKED_FAMILY_CONF="${folder}/worked_family.conf")
