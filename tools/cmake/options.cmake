# A compiler cache, where one is installed and the caller has named no other launcher.
find_program(REFLUX_CCACHE ccache)
if(REFLUX_CCACHE AND NOT CMAKE_C_COMPILER_LAUNCHER)
  set(CMAKE_C_COMPILER_LAUNCHER "${REFLUX_CCACHE}")
endif()

# One interface target that every target of ours links: language, warnings, floating-point rules.
set(CMAKE_C_STANDARD 11)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS ON)

add_library(reflux_options INTERFACE)
target_compile_options(reflux_options INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -Wvla -Werror
  -Wstrict-prototypes -Wmissing-prototypes
  -ffp-contract=off     # same float results on every processor: no fused multiply-add
  -fno-common)
if(REFLUX_FIXED_POINT)
  target_compile_definitions(reflux_options INTERFACE REFLUX_FIXED_POINT=1)
endif()
# Assertions (firmware/base/assertion.h): in every host build, and in an image of its own.
set(assertions OFF)
if(REFLUX_BOARD STREQUAL "host")
  set(assertions ON)
endif()
option(REFLUX_ASSERTIONS "Check what must hold, and stop where it does not" ${assertions})
if(REFLUX_ASSERTIONS)
  target_compile_definitions(reflux_options INTERFACE REFLUX_ASSERTIONS=1)
endif()
# The base image: regulatory control alone, without sequences and automatic start-up.
option(REFLUX_BASE "Leave sequences and automatic start-up out; the limits are those of limits_base.h" OFF)
set(limits limits.h)
if(REFLUX_BASE)
  set(limits limits_base.h)
  # These spend flash even under -Os: 1.6 KB. The full image keeps them, for the numbers of automatic start-up.
  target_compile_options(reflux_options INTERFACE -fno-move-loop-invariants -fno-inline-small-functions -fno-tree-ch
    -fno-shrink-wrap -fno-tree-sra -fno-code-hoisting -fno-tree-dominator-opts -fno-tree-pre -fno-if-conversion
    -fno-caller-saves -fno-tree-loop-im)
endif()
# The image of a small board whose plant is at its own pins, without the plant link.
option(REFLUX_PINS "Leave the plant link out for devices at the board's own pins; the limits are those of limits_pins.h" OFF)
if(REFLUX_PINS)
  set(limits limits_pins.h)
endif()
# A board smaller than the headers assume. On the host, -DREFLUX_LIMITS=stm32f100 tries such limits under sanitizers.
set(REFLUX_LIMITS "${REFLUX_BOARD}" CACHE STRING "Which folder of hal/ gives the limits, where it has a limits.h")
if(NOT IS_DIRECTORY "${PROJECT_SOURCE_DIR}/hal/${REFLUX_LIMITS}")
  message(FATAL_ERROR "REFLUX_LIMITS=${REFLUX_LIMITS}: there is no folder hal/${REFLUX_LIMITS}")
endif()
# The host has the limits of the STM32F405, so that both take the same settings.
set(of_board "${REFLUX_LIMITS}")
if(of_board STREQUAL "host")
  set(of_board stm32f405)
endif()
set(limits "${PROJECT_SOURCE_DIR}/hal/${of_board}/${limits}")
if(EXISTS "${limits}")
  target_compile_options(reflux_options INTERFACE "SHELL:-include ${limits}")
elseif(REFLUX_BASE)
  message(FATAL_ERROR "REFLUX_BASE: there is no ${limits}")
elseif(REFLUX_PINS)
  message(FATAL_ERROR "REFLUX_PINS: there is no ${limits}")
endif()
if(REFLUX_SANITIZE)
  target_compile_options(reflux_options INTERFACE
    -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(reflux_options INTERFACE -fsanitize=address,undefined)
  # A variable on the stack that nobody has set holds a pattern: as a pointer it crashes, as a number it is far out.
  # Unit and loop tests therefore run in a build where a value left over from another call cannot look right.
  target_compile_options(reflux_options INTERFACE -ftrivial-auto-var-init=pattern)
  # A tree links 350 programs; gold takes a quarter less time for each than the default linker.
  find_program(REFLUX_GOLD ld.gold)
  if(REFLUX_GOLD AND CMAKE_C_COMPILER_ID STREQUAL "GNU")
    target_link_options(reflux_options INTERFACE -fuse-ld=gold)
  endif()
endif()

if(REFLUX_FUZZ) # clang's warnings are not gcc's: they are shown, and stop nothing
  target_compile_options(reflux_options INTERFACE
    -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -Wno-error)
  target_link_options(reflux_options INTERFACE -fsanitize=address,undefined)
endif()
# Loops over every byte or every parameter: following each of their comparisons tells the fuzzer nothing and
# takes half of its time. Their edges count as everywhere.
function(reflux_untraced)
  if(REFLUX_FUZZ)
    set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -fno-sanitize-coverage=trace-cmp)
  endif()
endfunction()

# What holds for code that runs on a board, over and above: never a hidden double.
add_library(reflux_firmware_options INTERFACE)
target_link_libraries(reflux_firmware_options INTERFACE reflux_options)
target_compile_options(reflux_firmware_options INTERFACE -Wdouble-promotion)
if(CMAKE_CROSSCOMPILING)
  target_compile_options(reflux_firmware_options INTERFACE
    -ffunction-sections -fdata-sections -fstack-usage -fno-math-errno)
endif()
