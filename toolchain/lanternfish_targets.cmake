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
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

find_package(Eigen3 REQUIRED NO_MODULE)

set(LANTERNFISH_MARCH x86-64-v3 CACHE STRING "Instruction set (-march) on x86-64; empty for the compiler's default")
set(LANTERNFISH_SANITIZE "" CACHE STRING "Sanitizers, for instance address,undefined or thread")

# Flags of all our code, not of others' headers.
add_library(lanternfish_flags INTERFACE)
target_compile_options(lanternfish_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Werror)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(lanternfish_flags INTERFACE -Wno-restrict)  # "text" + std::string sets it off falsely (GCC bug 105651)
endif()
target_include_directories(lanternfish_flags INTERFACE ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/generated)
target_link_libraries(lanternfish_flags INTERFACE Eigen3::Eigen)
# Debian's PCL is built for SSE2: with AVX switched on, Eigen would align, allocate and free what both sides share differently.
target_compile_definitions(lanternfish_flags INTERFACE EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MALLOC_ALREADY_ALIGNED=1)
if(LANTERNFISH_MARCH AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  target_compile_options(lanternfish_flags INTERFACE -march=${LANTERNFISH_MARCH})
endif()
if(LANTERNFISH_SANITIZE)
  target_compile_options(lanternfish_flags INTERFACE
    -fsanitize=${LANTERNFISH_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(lanternfish_flags INTERFACE -fsanitize=${LANTERNFISH_SANITIZE})
endif()
set(sanitizer_sources)
if(LANTERNFISH_SANITIZE MATCHES "thread")
  set(sanitizer_sources ${CMAKE_CURRENT_LIST_DIR}/sanitizers/known_reports.cpp)
endif()

# lanternfish_library(NAME source... [LINK public...] [PRIVATE_LINK private...]): a folder's static library.
function(lanternfish_library name)
  cmake_parse_arguments(arg "" "" "LINK;PRIVATE_LINK" ${ARGN})
  add_library(${name} STATIC ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PUBLIC lanternfish_flags ${arg_LINK} PRIVATE ${arg_PRIVATE_LINK})
endfunction()

# lanternfish_core_library(...): the same under the core's rules: no exceptions, no RTTI, no heap.
function(lanternfish_core_library name)
  lanternfish_library(${name} ${ARGN})
  target_compile_options(${name} PRIVATE -fno-exceptions -fno-rtti -fno-threadsafe-statics -Wconversion -Wno-sign-conversion)
  target_compile_definitions(${name} PRIVATE EIGEN_NO_MALLOC EIGEN_NO_IO)
endfunction()

# lanternfish_test(NAME source... [LINK ...] [LABELS ...] [TIMEOUT s]): a GoogleTest program, one ctest entry a test case. Its time limit ends what hangs,
# not what is slow: the longest case takes a minute on two cores of 2026.
function(lanternfish_test name)
  cmake_parse_arguments(arg "" "TIMEOUT" "LINK;LABELS" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 1200)
  endif()
  find_package(GTest REQUIRED)
  include(GoogleTest)
  add_executable(${name} ${arg_UNPARSED_ARGUMENTS} ${sanitizer_sources})
  target_link_libraries(${name} PRIVATE lanternfish_flags ${arg_LINK} GTest::gmock GTest::gtest GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    LANTERNFISH_TEST_DATA="${CMAKE_SOURCE_DIR}/tests/data" LANTERNFISH_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 600 PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS "${arg_LABELS}")
endfunction()

# lanternfish_add_folders(folder...): the folders in the order of their dependencies.
function(lanternfish_add_folders)
  foreach(folder ${ARGN})
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/CMakeLists.txt)
      add_subdirectory(${folder})
    endif()
  endforeach()
endfunction()
