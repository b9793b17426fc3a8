# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# The three kinds of target: a library, a program, a test.

# What nearly every source of ours includes, parsed once: another half second for each of them otherwise. A missing include is found by
# clang-tidy, which reads each source without (scripts/tidy.py).
option(GRIDSPACE_PRECOMPILE "Precompile the headers that nearly every source includes" ON)
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang") # as CMake does it, but for ccache to see that the path is one
  set(CMAKE_CXX_COMPILE_OPTIONS_USE_PCH -include-pch <PCH_FILE>)
endif()
# gridspace_precompiled(NAME [PIE] DEPENDENCIES... HEADERS ...): for gridspace_use_precompiled(target NAME). PIE: for the sources of
# executables; those of libraries are compiled in another way, and a precompiled header serves one of the two.
function(gridspace_precompiled name)
  if(GRIDSPACE_PRECOMPILE)
    gridspace_precompiled_once(${name} ${ARGN})
    if(GRIDSPACE_SANITIZE) # and one of the optimized and the others
      gridspace_precompiled_once(quick_${name} ${ARGN})
      target_compile_options(gridspace_quick_${name} PRIVATE -O0)
    endif()
  endif()
endfunction()
function(gridspace_precompiled_once name)
  cmake_parse_arguments(arg "PIE" "" "HEADERS" ${ARGN})
  add_library(gridspace_${name} OBJECT "${PROJECT_SOURCE_DIR}/cmake/precompiled.cpp")
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang") # its precompiled headers name the folders of the clone: none goes into the compiler cache
    set_target_properties(gridspace_${name} PROPERTIES CXX_COMPILER_LAUNCHER "")
    target_compile_options(gridspace_${name} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
  if(arg_PIE)
    set_target_properties(gridspace_${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(gridspace_${name} PRIVATE -fPIE)
  endif()
  target_link_libraries(gridspace_${name} PRIVATE gridspace_flags ${arg_UNPARSED_ARGUMENTS})
  target_precompile_headers(gridspace_${name} PRIVATE ${arg_HEADERS})
  # A compiler never writes the same precompiled header twice. ccache takes this for its hash: what it is made of.
  file(GLOB parts /usr/include/fmt/core.h /usr/include/gmock/gmock.h /usr/include/gtest/gtest.h)
  set(sum "${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_SYSTEM_PROCESSOR} ${arg_HEADERS} ${arg_PIE}")
  foreach(part IN LISTS parts)
    file(SHA256 "${part}" hash)
    string(APPEND sum " ${hash}")
  endforeach()
  foreach(kind gch pch)
    file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/gridspace_${name}.dir/cmake_pch.hxx.${kind}.sum" "${sum}")
  endforeach()
endfunction()
function(gridspace_use_precompiled target name)
  if(GRIDSPACE_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM gridspace_${GRIDSPACE_QUICK}${name})
  endif()
endfunction()
set(GRIDSPACE_STANDARD_HEADERS
    <algorithm> <array> <charconv> <chrono> <cmath> <cstdint> <cstring> <filesystem> <fmt/format.h> <fstream> <functional> <map> <memory>
    <optional> <set> <span> <string> <string_view> <utility> <variant> <vector>)
gridspace_precompiled(standard_headers HEADERS ${GRIDSPACE_STANDARD_HEADERS})
gridspace_precompiled(program_headers PIE HEADERS ${GRIDSPACE_STANDARD_HEADERS})

# gridspace_compile_quickly(): for what waits on people and disks (launcher, web, files that are read once, tests), in this folder and
# below: -O1 takes a third less time than -O3; with sanitizers -O0 takes half that of -O1. No result depends on it: floating point is
# strict at every level.
macro(gridspace_compile_quickly)
  if(GRIDSPACE_SANITIZE)
    add_compile_options(-O0)
    set(GRIDSPACE_QUICK quick_)
  endif()
  add_compile_options($<$<CONFIG:Release>:-O1>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    add_compile_options(-Wno-stringop-overread) # at -O1 GCC bug 105651 goes by this name
  endif()
endmacro()

# Most of a compiler's time goes into what each source includes and instantiates: sources of a target are compiled some at a time, in less
# than half of the time. Names in unnamed namespaces are therefore their target's; a source whose names cannot be is named in APART.
set(GRIDSPACE_TOGETHER 8 CACHE STRING "How many sources of a target are compiled as one; 1: each by itself, for work on single files")
# gridspace_together(OUT TARGET SOURCES ... [APART ...]): the sources to compile in their place. (Not CMake's unity build: its files name
# the folders of the clone, which keeps them out of the compiler cache.)
function(gridspace_together out target)
  cmake_parse_arguments(arg "" "" "SOURCES;APART" ${ARGN})
  set(alone ${arg_SOURCES})
  set(joined ${arg_SOURCES})
  list(FILTER joined INCLUDE REGEX "^[^/].*\\.cpp$") # neither headers nor what is generated
  list(REMOVE_ITEM joined ${arg_APART} "")
  list(LENGTH joined count)
  if(GRIDSPACE_TOGETHER GREATER 1 AND count GREATER 1)
    list(REMOVE_ITEM alone ${joined})
    file(RELATIVE_PATH folder "${PROJECT_SOURCE_DIR}" "${CMAKE_CURRENT_SOURCE_DIR}")
    math(EXPR parts "(${count} + ${GRIDSPACE_TOGETHER} - 1) / ${GRIDSPACE_TOGETHER}")
    foreach(part RANGE 1 ${parts})
      math(EXPR first "${count} * (${part} - 1) / ${parts}")
      math(EXPR length "${count} * ${part} / ${parts} - ${first}")
      list(SUBLIST joined ${first} ${length} sources)
      list(TRANSFORM sources REPLACE "(.+)" "#include \"${folder}/\\1\"\n")
      string(JOIN "" text ${sources})
      set(file "${CMAKE_CURRENT_BINARY_DIR}/together/${target}_${part}.cpp")
      file(CONFIGURE OUTPUT "${file}" CONTENT "${text}" @ONLY)
      list(APPEND alone "${file}")
    endforeach()
  endif()
  set(${out} ${alone} PARENT_SCOPE)
endfunction()

# gridspace_library(NAME SOURCES a.cpp ... [APART a.cpp ...] [PUBLIC deps ...] [PRIVATE deps ...])
# Makes the static library gridspace_NAME with the alias gridspace::NAME. Headers are included from the project's root.
function(gridspace_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;APART;PUBLIC;PRIVATE" ${ARGN})
  gridspace_together(sources gridspace_${name} SOURCES ${arg_SOURCES} APART ${arg_APART})
  add_library(gridspace_${name} STATIC ${sources})
  add_library(gridspace::${name} ALIAS gridspace_${name})
  target_include_directories(gridspace_${name} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>")
  target_link_libraries(gridspace_${name} PUBLIC ${arg_PUBLIC} PRIVATE gridspace_flags ${arg_PRIVATE})
  gridspace_use_precompiled(gridspace_${name} standard_headers)
endfunction()

# The defaults of AddressSanitizer are part of each program of such a build (an object: from an archive nobody would ask for them).
if(GRIDSPACE_SANITIZE MATCHES "address")
  add_library(gridspace_sanitizer_defaults OBJECT "${PROJECT_SOURCE_DIR}/common/sanitizer_options.cpp")
endif()
function(gridspace_sanitizer_options target)
  if(TARGET gridspace_sanitizer_defaults)
    target_link_libraries(${target} PRIVATE gridspace_sanitizer_defaults)
  endif()
endfunction()

# gridspace_program(NAME SOURCES ... [APART ...] [PRIVATE deps ...] [FOR_CHECKOUTS]): an installed executable; all programs land in
# build/bin, and the target `programs` builds them and nothing else. FOR_CHECKOUTS: not among these, and not installed.
add_custom_target(programs)
function(gridspace_program name)
  cmake_parse_arguments(arg "FOR_CHECKOUTS" "" "SOURCES;APART;PRIVATE" ${ARGN})
  gridspace_together(sources ${name} SOURCES ${arg_SOURCES} APART ${arg_APART})
  add_executable(${name} ${sources})
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE gridspace_flags ${arg_PRIVATE})
  gridspace_use_precompiled(${name} program_headers)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
  if(GRIDSPACE_DEVICES_ONLY AND NOT GRIDSPACE_INSTALLED) # a bundle for a board may bring its libraries along, and theirs (hence not RUNPATH)
    set_target_properties(${name} PROPERTIES BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "$ORIGIN/../lib")
    target_link_options(${name} PRIVATE LINKER:--disable-new-dtags)
  endif()
  gridspace_sanitizer_options(${name})
  if(NOT arg_FOR_CHECKOUTS)
    add_dependencies(programs ${name})
    install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
endfunction()

add_custom_target(unit_tests) # builds the test programs with the label unit, and what they need
# gridspace_test(NAME SOURCES ... [APART ...] [PRIVATE deps ...] [LABELS l ...] [TIMEOUT seconds] [PARTS n] [ALONE]): GoogleTest cases, one
# CTest test each. ALONE: they measure time, so nothing else runs meanwhile. PARTS: they take so long that they run in so many parts at once.
function(gridspace_test name)
  cmake_parse_arguments(arg "ALONE" "TIMEOUT;PARTS" "SOURCES;APART;PRIVATE;LABELS" ${ARGN})
  if(NOT arg_LABELS)
    set(arg_LABELS unit)
  endif()
  if(NOT arg_PARTS)
    set(arg_PARTS 1)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300) # a busy machine is slow, and not wrong
  endif()
  if(CMAKE_CROSSCOMPILING) # in emulation
    math(EXPR arg_TIMEOUT "10 * ${arg_TIMEOUT}")
  endif()
  if(GRIDSPACE_DEVICES_ONLY) # what tests other parts is left out, and listed (tests/CMakeLists.txt)
    foreach(part IN LISTS arg_PRIVATE)
      if(part MATCHES "^gridspace::" AND NOT TARGET ${part})
        set_property(GLOBAL APPEND PROPERTY GRIDSPACE_TESTS_LEFT_OUT "${name} ${part}")
        return()
      endif()
    endforeach()
  endif()
  gridspace_together(sources ${name} SOURCES ${arg_SOURCES} APART ${arg_APART})
  add_executable(${name} ${sources})
  if("unit" IN_LIST arg_LABELS)
    add_dependencies(unit_tests ${name})
    set_property(GLOBAL APPEND PROPERTY GRIDSPACE_UNIT_TESTS "${name} ${arg_PARTS} $<IF:$<BOOL:${arg_ALONE}>,alone,beside>")
  endif()
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE gridspace_flags ${arg_PRIVATE} GTest::gmock GTest::gtest_main)
  gridspace_use_precompiled(${name} test_headers)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  gridspace_sanitizer_options(${name})
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 120 TEST_PREFIX "${name}."
                       PROPERTIES LABELS "${arg_LABELS}" TIMEOUT ${arg_TIMEOUT} RUN_SERIAL "${arg_ALONE}")
endfunction()
