# The worked family of docs/inside/adding-a-controller.md: kinds that no product has, on the whole firmware with the wood-berry column.
# They see what a folder of firmware/ would see; their table of kinds is linked in place of firmware/app/kinds.c.
set(folder "${CMAKE_CURRENT_LIST_DIR}/worked_family")
add_library(worked_family OBJECT EXCLUDE_FROM_ALL ${folder}/observer.c ${folder}/state_feedback.c ${folder}/kinds.c)
target_link_libraries(worked_family PRIVATE reflux_every_kind reflux_firmware_options)
set(bench reflux_hal_memory reflux_app reflux_link reflux_bench reflux_plants)
foreach(part worked_family worked_family_without worked_family_back)
  reflux_test(${part} LABEL loop SOURCES ${folder}/test_${part}.c LIBS worked_family ${bench})
endforeach()
# With the product's own table. What one build stores the next one reads.
reflux_test(worked_family_product LABEL loop SOURCES ${folder}/test_worked_family_product.c LIBS ${bench})
foreach(part worked_family worked_family_without worked_family_product worked_family_back)
  target_compile_definitions(test_${part} PRIVATE WORKED_FAMILY_CONF="${folder}/worked_family.conf"
    WORKED_FAMILY_FLASH="${CMAKE_CURRENT_BINARY_DIR}/worked_family.flash")
endforeach()
set_tests_properties(worked_family_without PROPERTIES FIXTURES_SETUP stored_with)
set_tests_properties(worked_family_product PROPERTIES FIXTURES_REQUIRED stored_with FIXTURES_SETUP stored_without)
set_tests_properties(worked_family_back PROPERTIES FIXTURES_REQUIRED stored_without)
reflux_test(worked_family_kinds LABEL loop SOURCES "${PROJECT_SOURCE_DIR}/tests/unit/test_kinds.c"
            LIBS worked_family reflux_every_kind)
