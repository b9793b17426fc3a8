# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# The dashboard is bundled with Node (18 or later) in the build tree. Without Node or its packages the monitor serves a
# plain page instead.
set(GRIDSPACE_DASHBOARD AUTO CACHE STRING "Bundle the dashboard: AUTO (when Node and its packages can be had), ON, OFF")
set_property(CACHE GRIDSPACE_DASHBOARD PROPERTY STRINGS AUTO ON OFF)

# gridspace_dashboard(RESULT): the folder with index.html, app.js, app.css and their .gz; empty when there is none.
function(gridspace_dashboard result)
  set(${result} "" PARENT_SCOPE)
  if(GRIDSPACE_DASHBOARD STREQUAL "OFF")
    return()
  endif()
  if(GRIDSPACE_DASHBOARD STREQUAL "ON")
    set(complain FATAL_ERROR)
  else()
    set(complain STATUS)
  endif()
  find_program(GRIDSPACE_NODE NAMES node nodejs)
  find_program(GRIDSPACE_NPM npm)
  if(NOT GRIDSPACE_NODE OR NOT GRIDSPACE_NPM)
    message(${complain} "Dashboard: Node and npm are not installed (apt install nodejs npm); the monitor has a plain page")
    return()
  endif()
  set(source "${PROJECT_SOURCE_DIR}/monitor/dashboard")
  set(work "${PROJECT_BINARY_DIR}/dashboard")
  file(GLOB files CONFIGURE_DEPENDS "${source}/src/*")
  file(MAKE_DIRECTORY "${work}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${source}/package.json" "${source}/package-lock.json")
  execute_process(
    COMMAND "${PROJECT_SOURCE_DIR}/scripts/npm_packages.sh" "${source}" "${work}"
    TIMEOUT 180
    RESULT_VARIABLE failed
    OUTPUT_QUIET ERROR_QUIET)
  if(failed)
    message(${complain} "Dashboard: npm ci failed (no network?); the monitor has a plain page. Configure again to retry")
    return()
  endif()
  set(outputs "")
  foreach(name IN ITEMS index.html app.js app.css)
    list(APPEND outputs "${work}/dist/${name}" "${work}/dist/${name}.gz")
  endforeach()
  add_custom_command(
    OUTPUT ${outputs}
    COMMAND "${CMAKE_COMMAND}" -E copy "${source}/build.mjs" "${source}/package.json" "${work}"
    COMMAND "${CMAKE_COMMAND}" -E rm -rf "${work}/src"
    COMMAND "${CMAKE_COMMAND}" -E copy_directory "${source}/src" "${work}/src"
    COMMAND "${CMAKE_COMMAND}" -E chdir "${work}" "${GRIDSPACE_NODE}" build.mjs dist
    DEPENDS ${files} "${source}/build.mjs" "${source}/package-lock.json"
    COMMENT "dashboard"
    VERBATIM)
  set(${result} "${work}/dist" PARENT_SCOPE)
endfunction()
