# Tests on a kernel that has SocketCAN (and V4L2), whatever this machine's has.
#
# lanternfish_guest_test(NAME vcan|qemu COMMAND word... [SECONDS s] [SLOWDOWN n] [SANITIZED])
#   vcan  vcan0 in real time: this machine's kernel, else User Mode Linux, on a clock that goes n times slower
#   qemu  two CAN cards on one bus and V4L2 loopback devices, on a clock that counts instructions; slow
# The tests carry the guest's name as a label and run alone, because they measure time. LANTERNFISH_GUEST_OUT names a folder to the command that is
# kept. All attempts together have `s` seconds; keeping_time.py says what an exit status means, and when an attempt is repeated.
# A test is skipped on a machine that does not keep time, and where a guest cannot be had; where CI=true, the latter is a failure. Sanitizers do not run in
# User Mode Linux: under them `vcan` tests marked SANITIZED, which need no real time, run in the other guest, and the rest is left out.
set(guests ${CMAKE_SOURCE_DIR}/toolchain/guests)
add_executable(watch_time ${guests}/watch_time.cpp)
add_library(uml_preload MODULE ${guests}/slow_clock.cpp)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  target_sources(uml_preload PRIVATE ${guests}/whole_xstate.cpp)
endif()
# Without sanitizers: the one locks all its memory, the other is a guest in somebody else's program.
target_compile_options(watch_time PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Werror)
target_compile_options(uml_preload PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Werror)
set_target_properties(watch_time uml_preload PROPERTIES
  RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)

function(lanternfish_guest_test name guest)
  cmake_parse_arguments(arg "SANITIZED" "SECONDS;SLOWDOWN" "COMMAND" ${ARGN})
  if(NOT arg_SECONDS)
    set(arg_SECONDS 120)
  endif()
  if(LANTERNFISH_SANITIZE)
    if(NOT arg_SANITIZED)
      return()
    endif()
    set(guest qemu)
    math(EXPR arg_SECONDS "${arg_SECONDS} * 4")
  endif()
  set(guests ${CMAKE_SOURCE_DIR}/toolchain/guests)
  set(out ${CMAKE_BINARY_DIR}/guest_out/${name})
  file(MAKE_DIRECTORY ${out})
  if(guest STREQUAL "vcan")
    set(runner ${guests}/with_vcan.sh --memory 1500M --preload $<TARGET_FILE:uml_preload>)
    if(arg_SLOWDOWN)
      list(APPEND runner --slowdown ${arg_SLOWDOWN})
    endif()
  else()
    set(runner --own-clock ${guests}/run_in_qemu.sh --guest ${CMAKE_BINARY_DIR}/qemu_guest)
  endif()
  add_test(NAME ${name} COMMAND ${guests}/keeping_time.py --watch $<TARGET_FILE:watch_time> --out ${out} --lost ${CMAKE_BINARY_DIR}/guest_out/lost --seconds ${arg_SECONDS}
    ${runner} --out ${out} -- ${arg_COMMAND})
  math(EXPR limit "${arg_SECONDS} + 900")  # the runner's own limit comes first and says more; the guest's first download and build count here
  set_tests_properties(${name} PROPERTIES LABELS ${guest} RUN_SERIAL ON TIMEOUT ${limit} ENVIRONMENT LANTERNFISH_GUEST_OUT=${out}
    SKIP_RETURN_CODE 77)
endfunction()
