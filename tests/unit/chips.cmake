# Models of the chips around the board, asked byte by byte as their data sheets say.
foreach(about ad5422 ads1115 at_pin barometer bus ds18b20 kinds max31856 max31865 rubbish spi thermocouple wiring xgzp6897)
  reflux_test(chips_${about} LABEL unit SOURCES "${CMAKE_CURRENT_LIST_DIR}/test_chips_${about}.c" LIBS reflux_chips)
endforeach()
