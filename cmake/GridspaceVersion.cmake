# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# Writes version.cpp at build time, and only when something in it has changed.
# Called as a script by the target gridspace_version_source; included to define that target.

if(CMAKE_SCRIPT_MODE_FILE)
  execute_process(
    COMMAND git describe --always --dirty --abbrev=12
    WORKING_DIRECTORY "${SOURCE_DIR}"
    OUTPUT_VARIABLE GRIDSPACE_COMMIT
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(READ "${SOURCE_DIR}/cmake/archive_commit.txt" archived) # `git archive` writes the commit into it
  string(STRIP "${archived}" archived)
  if(archived MATCHES "^[0-9a-f]+$")
    set(GRIDSPACE_COMMIT "${archived}")
  elseif(NOT GRIDSPACE_COMMIT)
    set(GRIDSPACE_COMMIT unknown)
  endif()
  configure_file("${SOURCE_DIR}/common/version.cpp.in" "${OUT}" @ONLY)
  return()
endif()

set(GRIDSPACE_VERSION_SOURCE "${PROJECT_BINARY_DIR}/generated/version.cpp")
add_custom_target(
  gridspace_version_source
  COMMAND
    "${CMAKE_COMMAND}" "-DSOURCE_DIR=${PROJECT_SOURCE_DIR}" "-DOUT=${GRIDSPACE_VERSION_SOURCE}"
    "-DPROJECT_VERSION=${PROJECT_VERSION}" "-DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}"
    "-DCMAKE_CXX_COMPILER_ID=${CMAKE_CXX_COMPILER_ID}" "-DCMAKE_CXX_COMPILER_VERSION=${CMAKE_CXX_COMPILER_VERSION}" -P
    "${CMAKE_CURRENT_LIST_FILE}"
  BYPRODUCTS "${GRIDSPACE_VERSION_SOURCE}"
  COMMENT ""
  VERBATIM)
