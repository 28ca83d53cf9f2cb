# A random walk over the whole firmware, with the kinds of all tests and of the worked family in one table.
set(folder "${CMAKE_CURRENT_LIST_DIR}/worked_family")
add_library(walk_family OBJECT EXCLUDE_FROM_ALL ${folder}/observer.c ${folder}/state_feedback.c)
target_link_libraries(walk_family PRIVATE reflux_every_kind reflux_firmware_options)
reflux_test(walk LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_walk.c
            LIBS walk_family reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants
                 reflux_every_kind)
target_include_directories(test_walk PRIVATE "${CMAKE_CURRENT_LIST_DIR}")
target_compile_definitions(test_walk PRIVATE WORKED_FAMILY_CONF="${folder}/worked_family.conf")
