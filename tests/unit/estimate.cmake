# Not a test by itself: covariances of a million updates (tools/campaign kalman).
set(kalman "${PROJECT_SOURCE_DIR}/tests/campaign/endurance/kalman")
add_executable(endurance_kalman ${kalman}_main.c ${kalman}_course.c ${kalman}_forms.c
               "${PROJECT_SOURCE_DIR}/tests/bench/estimation/column.c")
target_link_libraries(endurance_kalman PRIVATE reflux_every_kind reflux_options m)
target_include_directories(endurance_kalman PRIVATE "${PROJECT_SOURCE_DIR}/tests/support" "${PROJECT_SOURCE_DIR}/tests/bench/estimation")
target_compile_options(endurance_kalman PRIVATE -O3) # of the products of matrices there are many

# Not a test by itself: columns that differ from an estimator's model (tools/campaign composition).
set(composition "${PROJECT_SOURCE_DIR}/tests/campaign/composition")
add_executable(composition_campaign ${composition}/main.c)
target_link_libraries(composition_campaign PRIVATE reflux_every_kind reflux_options m)
target_include_directories(composition_campaign PRIVATE "${PROJECT_SOURCE_DIR}/tests/support")
add_test(NAME composition_campaign COMMAND composition_campaign ${composition}/sample.txt 9)
reflux_programs_of_test(composition_campaign unit composition_campaign)
