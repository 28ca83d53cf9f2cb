# The finished console: access levels, people at it, a paste over a line that loses bytes.
foreach(part access console_people listings paste)
  reflux_test(${part} LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
              LIBS reflux_hal_memory reflux_app reflux_link)
endforeach()
target_sources(test_paste PRIVATE "${PROJECT_SOURCE_DIR}/tests/support/uart_model.c")
# Days of a board with everything in use, beside tests/reference/days.txt: numbers of the float build.
if(NOT REFLUX_FIXED_POINT)
  reflux_test(days LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_days.c
              LIBS reflux_hal_memory reflux_app reflux_link)
endif()
# Plants that come and go, beside tests/reference/plants.txt.
reflux_test(plants_come_and_go LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_plants_come_and_go.c
            LIBS reflux_hal_memory reflux_app reflux_link)
# What may be set and what may not, beside tests/reference/settings.txt.
reflux_test(settings LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_settings.c
            LIBS reflux_hal_memory reflux_app reflux_link)
