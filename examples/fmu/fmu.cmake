# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# example_fmu(MODEL VERSION OUTPUT SOURCE DESCRIPTION): OUTPUT is an FMU for this machine. MODEL is its modelIdentifier.
set(example_fmu_folder "${CMAKE_CURRENT_LIST_DIR}")

function(example_fmu model version output source description)
  get_filename_component(name "${output}" NAME_WE)
  set(stage "${CMAKE_CURRENT_BINARY_DIR}/${name}")
  if(version EQUAL 2 AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    set(platform linux64)
  else()
    set(platform "${CMAKE_SYSTEM_PROCESSOR}-linux")
  endif()
  add_library(fmu_${name} MODULE "${source}" "${example_fmu_folder}/fmi${version}.c")
  set_target_properties(fmu_${name} PROPERTIES COMPILE_OPTIONS "" LINK_OPTIONS "") # an FMU knows nothing of who uses it (sanitizers)
  target_include_directories(fmu_${name} PRIVATE "${example_fmu_folder}")
  target_compile_options(fmu_${name} PRIVATE -Wall -Wextra -ffp-contract=off -fvisibility=hidden)
  target_link_libraries(fmu_${name} PRIVATE m)
  set_target_properties(fmu_${name} PROPERTIES PREFIX "" OUTPUT_NAME "${model}" C_STANDARD 11
                                               LIBRARY_OUTPUT_DIRECTORY "${stage}/binaries/${platform}")
  add_custom_command(
    OUTPUT "${output}"
    COMMAND "${CMAKE_COMMAND}" -E copy "${description}" "${stage}/modelDescription.xml"
    COMMAND "${CMAKE_COMMAND}" -E chdir "${stage}" "${CMAKE_COMMAND}" -E tar cf "${output}" --format=zip modelDescription.xml binaries
    DEPENDS fmu_${name} "${description}"
    VERBATIM)
  add_custom_target(fmu_${name}_file ALL DEPENDS "${output}")
endfunction()
