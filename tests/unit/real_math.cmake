reflux_test(real_math LABEL unit SOURCES test_real_math.c LIBS reflux_num)
