# Tests on a kernel that has SocketCAN (and V4L2), whatever this machine's has.
#
# lanternfish_guest_test(NAME vcan|qemu COMMAND word... [TIMEOUT s] [SANITIZED])
#   vcan  vcan0 in real time: this machine's kernel, else User Mode Linux
#   qemu  two CAN cards on one bus and V4L2 loopback devices, on a clock that counts instructions; slow
# Labelled so, and run alone: what they measure is time. LANTERNFISH_GUEST_OUT names to the command a folder that is kept.
# Skipped, with the package to install, where a guest cannot be had. Sanitizers do not run in User Mode Linux: under them `vcan` tests
# marked SANITIZED, which need no real time, run in the other guest, and the rest is left out.
function(lanternfish_guest_test name guest)
  cmake_parse_arguments(arg "SANITIZED" "TIMEOUT" "COMMAND" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 60)
  endif()
  if(LANTERNFISH_SANITIZE)
    if(NOT arg_SANITIZED)
      return()
    endif()
    set(guest qemu)
    math(EXPR arg_TIMEOUT "${arg_TIMEOUT} * 4")
  endif()
  set(guests ${CMAKE_SOURCE_DIR}/toolchain/guests)
  if(guest STREQUAL "vcan")
    set(runner ${guests}/with_vcan.sh)
    set(memory --memory 1500M)
  else()
    set(runner ${guests}/run_in_qemu.sh --guest ${CMAKE_BINARY_DIR}/qemu_guest)
  endif()
  set(out ${CMAKE_BINARY_DIR}/guest_out/${name})
  file(MAKE_DIRECTORY ${out})
  add_test(NAME ${name} COMMAND ${runner} --time-limit ${arg_TIMEOUT} ${memory} --out ${out} ${arg_COMMAND})
  math(EXPR limit "${arg_TIMEOUT} + 180")  # the runner's own limit comes first and says more; the guest's first download and build count here
  set_tests_properties(${name} PROPERTIES LABELS ${guest} RUN_SERIAL ON TIMEOUT ${limit} ENVIRONMENT LANTERNFISH_GUEST_OUT=${out}
    SKIP_REGULAR_EXPRESSION "(run_in_uml|run_in_qemu|with_vcan): no .*: ")
endfunction()
