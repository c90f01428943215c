# How every target of Lanternfish is built: language, warnings, sanitizers, and the three kinds of target.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(CCACHE ccache)
if(CCACHE)
  # ccache refuses to keep what uses a precompiled header unless it is told to trust the header's own contents.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE})
endif()

find_package(Eigen3 REQUIRED NO_MODULE)

set(LANTERNFISH_MARCH x86-64-v3 CACHE STRING "Instruction set (-march) on x86-64; empty for the compiler's default")
set(LANTERNFISH_SANITIZE "" CACHE STRING "Sanitizers, for instance address,undefined or thread")
set(LANTERNFISH_SANITIZE_NOT "" CACHE STRING "Of these, the checks that are left out")
option(LANTERNFISH_COVERAGE "Count what the tests execute: tests/coverage.sh" OFF)
option(LANTERNFISH_FUZZ "Build the fuzz targets alone, with libFuzzer: tests/fuzz.sh; needs Clang" OFF)

# Flags of all our code, not of others' headers.
add_library(lanternfish_flags INTERFACE)
target_compile_options(lanternfish_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Werror)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(lanternfish_flags INTERFACE -Wno-restrict -Wno-stringop-overflow)  # "text" + std::string sets both off falsely (GCC bug 105651)
endif()
target_include_directories(lanternfish_flags INTERFACE ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/generated)
target_link_libraries(lanternfish_flags INTERFACE Eigen3::Eigen)
# Debian's PCL is built for SSE2: with AVX switched on, Eigen would align, allocate and free what both sides share differently.
target_compile_definitions(lanternfish_flags INTERFACE EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MALLOC_ALREADY_ALIGNED=1)
if(LANTERNFISH_MARCH AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  target_compile_options(lanternfish_flags INTERFACE -march=${LANTERNFISH_MARCH})
elseif(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(lanternfish_flags INTERFACE -Wno-psabi)  # remarks on how vectors are passed where a processor has no registers of their width
endif()
if(LANTERNFISH_SANITIZE)
  target_compile_options(lanternfish_flags INTERFACE
    -fsanitize=${LANTERNFISH_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(lanternfish_flags INTERFACE -fsanitize=${LANTERNFISH_SANITIZE})
  if(LANTERNFISH_SANITIZE_NOT)
    target_compile_options(lanternfish_flags INTERFACE -fno-sanitize=${LANTERNFISH_SANITIZE_NOT})
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(lanternfish_flags INTERFACE -Wno-maybe-uninitialized)  # GCC warns of its own instrumentation
  endif()
endif()
if(LANTERNFISH_COVERAGE)
  # What is inlined before it is counted has no lines of its own. Without that GCC 12 takes what Eigen fills by a call for uninitialised.
  target_compile_options(lanternfish_flags INTERFACE --coverage -fno-early-inlining -Wno-maybe-uninitialized)
  target_link_options(lanternfish_flags INTERFACE --coverage)
  target_compile_definitions(lanternfish_flags INTERFACE LANTERNFISH_COUNTS_LINES)
endif()
if(LANTERNFISH_FUZZ)
  # Clang 14 cannot look for wrong object types (vptr) in the core, which has no RTTI. It warns of other things than GCC, by which the code is held.
  target_compile_options(lanternfish_flags INTERFACE -fsanitize=fuzzer-no-link -fno-sanitize=vptr -Wno-error)
  target_link_options(lanternfish_flags INTERFACE -fno-sanitize=vptr)
endif()
set(sanitizer_sources)
if(LANTERNFISH_SANITIZE MATCHES "thread")
  set(sanitizer_sources ${CMAKE_CURRENT_LIST_DIR}/sanitizers/known_reports.cpp)
endif()

# Eigen alone takes 3 s to read, and nearly every file reads it: one precompiled header for each set of flags. Cross builds go without, and
# so prove that every header includes what it needs.
set(precompile_default OFF)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_CROSSCOMPILING)
  set(precompile_default ON)
endif()
option(LANTERNFISH_PRECOMPILE "Precompile the headers that nearly every file includes" ${precompile_default})
set(precompiled_headers <algorithm> <array> <cmath> <cstdint> <optional> <span> <utility> <Eigen/Core> <Eigen/Geometry>)
set(precompiled_hosted ${precompiled_headers} <chrono> <functional> <map> <memory> <sstream> <string> <variant> <vector>)

# lanternfish_precompile(TARGET KIND header...): compiles the headers once for all targets of a kind; they have to have the same flags.
function(lanternfish_precompile target kind)
  if(NOT LANTERNFISH_PRECOMPILE)
    return()
  endif()
  set(owner lf_precompiled_${kind})
  if(NOT TARGET ${owner})
    file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/generated/precompiled_${kind}.cpp CONTENT "")
    add_library(${owner} OBJECT ${CMAKE_BINARY_DIR}/generated/precompiled_${kind}.cpp)
    target_link_libraries(${owner} PRIVATE lanternfish_flags)
    if(kind STREQUAL "core")
      lanternfish_core_flags(${owner})
    elseif(kind MATCHES "test")
      target_link_libraries(${owner} PRIVATE GTest::gmock GTest::gtest)
      if(kind STREQUAL "light_test")
        lanternfish_light_flags(${owner})
      endif()
    elseif(kind STREQUAL "program")
      target_link_libraries(${owner} PRIVATE CLI11::CLI11 nlohmann_json::nlohmann_json)
    endif()
    target_compile_options(${owner} PRIVATE -fpch-preprocess)
    target_precompile_headers(${owner} PRIVATE ${ARGN})
  endif()
  target_compile_options(${target} PRIVATE -fpch-preprocess)
  target_precompile_headers(${target} REUSE_FROM ${owner})
  if(NOT kind STREQUAL "core" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-array-bounds)  # the same bug as above, through a precompiled <string>
  endif()
  # A target with other macros cannot use the header and reads it as text: slower, not wrong.
  set_target_properties(${target} PROPERTIES PCH_WARN_INVALID OFF)
endfunction()

# The programs' sources, most of which read the command line's and JSON's headers: half of the time that they take.
function(lanternfish_precompile_program target)
  lanternfish_precompile(${target} program ${precompiled_hosted} <CLI/App.hpp> <nlohmann/json.hpp>)
endfunction()

# Of tests that compute little: their files compile in two thirds of the time.
function(lanternfish_light_flags target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
endfunction()

# The core's rules: no exceptions, no RTTI, no heap.
function(lanternfish_core_flags target)
  target_compile_options(${target} PRIVATE -fno-exceptions -fno-rtti -fno-threadsafe-statics -Wconversion -Wno-sign-conversion)
  target_compile_definitions(${target} PRIVATE EIGEN_NO_MALLOC EIGEN_NO_IO)
  if(LANTERNFISH_COVERAGE)
    target_compile_options(${target} PRIVATE -Og)  # nearly every line keeps its own count; at -O0 Eigen makes a mission take minutes
  endif()
endfunction()

# lanternfish_library(NAME source... [LINK public...] [PRIVATE_LINK private...]): a folder's static library.
function(lanternfish_library name)
  cmake_parse_arguments(arg "CORE" "" "LINK;PRIVATE_LINK" ${ARGN})
  add_library(${name} STATIC ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PUBLIC lanternfish_flags ${arg_LINK} PRIVATE ${arg_PRIVATE_LINK})
  if(NOT arg_CORE)
    lanternfish_precompile(${name} hosted ${precompiled_hosted})
  endif()
endfunction()

# lanternfish_core_library(...): the same under the core's rules.
function(lanternfish_core_library name)
  lanternfish_library(${name} CORE ${ARGN})
  lanternfish_core_flags(${name})
  lanternfish_precompile(${name} core ${precompiled_headers})
endfunction()

# lanternfish_test(NAME source... [LINK ...] [LABELS ...] [LONG filter] [TIMEOUT s] [LIGHT]): a GoogleTest program, one ctest entry a test case. LONG: the cases that
# a filter of GoogleTest's names have the label `hil_long` in place of `hil`. ctest's -L and -LE find it by either part: `./test.sh` leaves these cases to
# `./test.sh release` and to tests/nightly.sh. The time limit ends what hangs, not what is slow: the longest case takes a minute on two cores of 2026.
# LIGHT: its own files are optimised less, and so is what they include of ours. That
# is for tests of text, files and protocols: arithmetic in headers has to be tested as it is shipped.
function(lanternfish_test name)
  cmake_parse_arguments(arg "LIGHT" "TIMEOUT;LONG" "LINK;LABELS" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 1200)
  endif()
  find_package(GTest REQUIRED)
  include(GoogleTest)
  add_executable(${name} ${arg_UNPARSED_ARGUMENTS} ${sanitizer_sources})
  target_link_libraries(${name} PRIVATE lanternfish_flags ${arg_LINK} GTest::gmock GTest::gtest GTest::gtest_main)
  set(kind test)
  if(arg_LIGHT)
    set(kind light_test)
    lanternfish_light_flags(${name})
  endif()
  lanternfish_precompile(${name} ${kind} ${precompiled_hosted} <gmock/gmock.h> <gtest/gtest.h>)
  target_compile_definitions(${name} PRIVATE
    LANTERNFISH_TEST_DATA="${CMAKE_SOURCE_DIR}/tests/data" LANTERNFISH_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  set(discovery NO_PRETTY_VALUES DISCOVERY_TIMEOUT 600)  # what a value looks like may change from run to run, and with it the test's name
  if(arg_LONG)
    gtest_discover_tests(${name} ${discovery} TEST_FILTER "-${arg_LONG}" PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS "${arg_LABELS}")
    gtest_discover_tests(${name} ${discovery} TEST_FILTER "${arg_LONG}" TEST_LIST ${name}_LONG PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS "${arg_LABELS}_long")
  else()
    gtest_discover_tests(${name} ${discovery} PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS "${arg_LABELS}")
  endif()
endfunction()

# lanternfish_check_cpu(PROGRAM): it says which instructions a processor lacks, and ends with 3, in place of an illegal instruction somewhere.
function(lanternfish_check_cpu program)
  if(NOT LANTERNFISH_MARCH OR NOT CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    return()
  endif()
  add_library(${program}_cpu_check OBJECT ${CMAKE_SOURCE_DIR}/toolchain/cpu_check/cpu_check.cpp)
  target_compile_options(${program}_cpu_check PRIVATE -std=c++20 -O2 -Wall -Wextra -march=x86-64)
  target_compile_definitions(${program}_cpu_check PRIVATE LANTERNFISH_PROGRAM="${program}")
  if(LANTERNFISH_MARCH MATCHES "v3|v4")
    target_compile_definitions(${program}_cpu_check PRIVATE LANTERNFISH_NEEDS_AVX2)
  endif()
  target_sources(${program} PRIVATE $<TARGET_OBJECTS:${program}_cpu_check>)
endfunction()

# lanternfish_add_folders(folder...): the folders in the order of their dependencies.
function(lanternfish_add_folders)
  foreach(folder ${ARGN})
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/CMakeLists.txt)
      add_subdirectory(${folder})
    endif()
  endforeach()
endfunction()
