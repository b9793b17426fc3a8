# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# Build options and the compile flags that every target of ours carries.

option(GRIDSPACE_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(GRIDSPACE_DEVICES_ONLY "Only what runs on a board: agents, gateways, detector, recorder; no simulator, monitor, launcher" OFF)
option(GRIDSPACE_INSTALLED "For a package: the programs know the installed folders and no tree of sources" OFF)
option(GRIDSPACE_BENCH "Build the benchmarks" OFF)
option(GRIDSPACE_FUZZ "Build the libFuzzer targets (needs clang)" OFF)
option(GRIDSPACE_COVERAGE "Count the lines of the frame decoder that run" OFF)
set(GRIDSPACE_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")

set(CMAKE_CXX_STANDARD 23)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

# Every clone of a machine shares one compiler cache: paths below the root count as relative ones, and no path reaches the objects.
find_program(GRIDSPACE_CCACHE ccache)
if(GRIDSPACE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1 CCACHE_PCH_EXTSUM=1
      CCACHE_SLOPPINESS=pch_defines,time_macros # what it needs to keep sources that use a precompiled header
      "${GRIDSPACE_CCACHE}")
  set(CMAKE_C_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()

add_library(gridspace_flags INTERFACE)
# What fmt::fmt defines, for all: a precompiled header serves only who is compiled with the same definitions.
target_compile_definitions(gridspace_flags INTERFACE FMT_SHARED)
# Results must not depend on the compiler's freedom to fuse a multiply and an add (docs/design/determinism.md).
target_compile_options(gridspace_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor
                                                 -ffp-contract=off -fno-math-errno)
option(GRIDSPACE_WERROR "A warning in our own code is an error (OFF for compilers that nobody has tried)" ON)
if(GRIDSPACE_WERROR)
  target_compile_options(gridspace_flags INTERFACE -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False alarms on std::string and std::optional (GCC bugs 105329, 105651, 105562, 80635).
  target_compile_options(gridspace_flags INTERFACE -Wno-restrict -Wno-stringop-overflow -Wno-array-bounds -Wno-maybe-uninitialized)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU") # it takes a source that is compiled with others for a header (GRIDSPACE_TOGETHER)
  target_compile_options(gridspace_flags INTERFACE -Wno-subobject-linkage)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  target_compile_options(gridspace_flags INTERFACE -Wno-deprecated-declarations # libstdc++ 12 uses its own std::get_temporary_buffer
                                                   -Wno-sign-conversion) # not part of g++'s -Wconversion
endif()
if(NOT GRIDSPACE_SANITIZE)
  target_compile_options(gridspace_flags INTERFACE -fstack-protector-strong -fstack-clash-protection
                                                   $<$<CONFIG:Release>:-D_FORTIFY_SOURCE=2>)
  target_link_options(gridspace_flags INTERFACE -Wl,-z,relro,-z,now,-z,noexecstack)
endif()
target_compile_definitions(gridspace_flags INTERFACE _GLIBCXX_ASSERTIONS)

if(GRIDSPACE_SANITIZE)
  add_compile_options(-fsanitize=${GRIDSPACE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all -g1)
  add_link_options(-fsanitize=${GRIDSPACE_SANITIZE})
endif()

if(GRIDSPACE_COVERAGE)
  add_link_options(--coverage)
endif()

if(GRIDSPACE_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link) # coverage that guides the fuzzer
endif()

find_program(GRIDSPACE_MOLD mold)
if(GRIDSPACE_MOLD AND NOT CMAKE_CROSSCOMPILING)
  add_link_options(-fuse-ld=mold)
endif()
