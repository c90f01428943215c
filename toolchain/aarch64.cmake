# 64-bit ARM under Debian 12, the vehicle's computer: Debian's cross compiler, and a folder of arm64 packages which toolchain/aarch64/make_sysroot.sh
# makes. Programs of the build, the tests among them, run under qemu-user.
#   ./test.sh aarch64
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(LANTERNFISH_SYSROOT ${CMAKE_CURRENT_LIST_DIR}/../build/aarch64-sysroot CACHE PATH "Folder of arm64 packages")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES LANTERNFISH_SYSROOT)
if(NOT EXISTS ${LANTERNFISH_SYSROOT}/made_of)
  message(FATAL_ERROR "${LANTERNFISH_SYSROOT} has no arm64 packages: run toolchain/aarch64/make_sysroot.sh ${LANTERNFISH_SYSROOT}")
endif()
cmake_path(ABSOLUTE_PATH LANTERNFISH_SYSROOT NORMALIZE OUTPUT_VARIABLE CMAKE_SYSROOT)

set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
# The build's programs are this machine's; libraries, headers and CMake files the other's.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64;-L;${CMAKE_SYSROOT})
