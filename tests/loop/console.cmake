# The finished console: access levels, people at it, a paste over a line that loses bytes.
foreach(part access console_people console_words diff_saved event_sentences listings paste tune_doubt)
  reflux_test(${part} LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${part}.c
              LIBS reflux_hal_memory reflux_app reflux_link)
endforeach()
target_include_directories(test_diff_saved PRIVATE "${PROJECT_SOURCE_DIR}/hal/host")
target_sources(test_paste PRIVATE "${PROJECT_SOURCE_DIR}/tests/support/uart_model.c")
# Stored sets and .conf files stay valid, beside tests/reference/settings.txt.
reflux_test(settings LABEL loop SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_settings.c
            LIBS reflux_hal_memory reflux_app reflux_link)
