# A bare Cortex-M7 with double-precision floating point, by Debian's arm-none-eabi GCC and newlib: for the core alone, which has no operating system.
#   cmake --preset cortex-m7 && cmake --build --preset cortex-m7
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR cortex-m7)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)  # a program needs the linker script
# Eigen is headers alone, the same for every machine.
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY NEVER)

# -Wno-psabi: remarks on how GCC 6 passed arguments.
set(cpu -mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard)
list(JOIN cpu " " cpu)
set(CMAKE_C_FLAGS_INIT "${cpu} -Wno-psabi -ffunction-sections -fdata-sections")
set(CMAKE_CXX_FLAGS_INIT "${CMAKE_C_FLAGS_INIT} -DLANTERNFISH_SMALL_CORE -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit")
set(CMAKE_CXX_STANDARD_LIBRARIES_INIT "-Wl,--start-group -lc -lm -lgcc -Wl,--end-group")
