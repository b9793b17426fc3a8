# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# The three kinds of target: a library, a program, a test.

# gridspace_library(NAME SOURCES a.cpp ... [PUBLIC deps ...] [PRIVATE deps ...])
# Makes the static library gridspace_NAME with the alias gridspace::NAME. Headers are included from the project's root.
function(gridspace_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(gridspace_${name} STATIC ${arg_SOURCES})
  add_library(gridspace::${name} ALIAS gridspace_${name})
  target_include_directories(gridspace_${name} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>")
  target_link_libraries(gridspace_${name} PUBLIC ${arg_PUBLIC} PRIVATE gridspace_flags ${arg_PRIVATE})
endfunction()

# The defaults of AddressSanitizer are part of each program of such a build.
function(gridspace_sanitizer_options target)
  if(GRIDSPACE_SANITIZE MATCHES "address" AND NOT GRIDSPACE_FUZZ)
    target_sources(${target} PRIVATE "${PROJECT_SOURCE_DIR}/common/sanitizer_options.cpp")
  endif()
endfunction()

# gridspace_program(NAME SOURCES ... [PRIVATE deps ...]): an installed executable; all programs land in build/bin, and the target
# `programs` builds them and nothing else.
add_custom_target(programs)
function(gridspace_program name)
  cmake_parse_arguments(arg "" "" "SOURCES;PRIVATE" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE gridspace_flags ${arg_PRIVATE})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
  if(GRIDSPACE_DEVICES_ONLY) # a bundle for a board may bring its libraries along, and theirs (hence not RUNPATH)
    set_target_properties(${name} PROPERTIES BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "$ORIGIN/../lib")
    target_link_options(${name} PRIVATE LINKER:--disable-new-dtags)
  endif()
  add_dependencies(programs ${name})
  gridspace_sanitizer_options(${name})
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()

# gridspace_test(NAME SOURCES ... [PRIVATE deps ...] [LABELS l ...] [TIMEOUT seconds]): GoogleTest cases, one CTest test each.
function(gridspace_test name)
  cmake_parse_arguments(arg "" "TIMEOUT" "SOURCES;PRIVATE;LABELS" ${ARGN})
  if(NOT arg_LABELS)
    set(arg_LABELS unit)
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
  add_executable(${name} ${arg_SOURCES})
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE gridspace_flags ${arg_PRIVATE} GTest::gmock GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  gridspace_sanitizer_options(${name})
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 120 TEST_PREFIX "${name}."
                       PROPERTIES LABELS "${arg_LABELS}" TIMEOUT ${arg_TIMEOUT})
endfunction()
