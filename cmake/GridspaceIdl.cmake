# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# gridspace_idl_library(NAME a.idl b.idl ...): C++ types and CDR code by fastddsgen, in the build tree only.
# No type objects: Fast DDS 2.9.1 participants crash on each other's (docs/design/bus.md).

find_package(fastcdr REQUIRED)
find_package(fastrtps 2.9 REQUIRED)
find_program(FASTDDSGEN fastddsgen REQUIRED)

function(gridspace_idl_library name)
  set(out "${CMAKE_CURRENT_BINARY_DIR}/generated/${name}")
  file(MAKE_DIRECTORY "${out}") # fastddsgen wants it to exist
  set(sources)
  foreach(idl IN LISTS ARGN)
    get_filename_component(stem "${idl}" NAME_WE)
    get_filename_component(path "${idl}" ABSOLUTE)
    get_filename_component(dir "${path}" DIRECTORY)
    set(generated "${out}/${stem}.cxx" "${out}/${stem}PubSubTypes.cxx" "${out}/${stem}.h" "${out}/${stem}PubSubTypes.h")
    add_custom_command(
      OUTPUT ${generated}
      COMMAND "${CMAKE_COMMAND}" "-DFASTDDSGEN=${FASTDDSGEN}" "-DIDL=${path}" "-DDIR=${dir}" "-DSTEM=${stem}" "-DOUT=${out}"
              -P "${PROJECT_SOURCE_DIR}/cmake/run_fastddsgen.cmake"
      DEPENDS "${path}" "${PROJECT_SOURCE_DIR}/cmake/run_fastddsgen.cmake"
      COMMENT "fastddsgen ${stem}.idl"
      VERBATIM)
    list(APPEND sources ${generated})
  endforeach()
  add_library(gridspace_${name} STATIC ${sources})
  add_library(gridspace::${name} ALIAS gridspace_${name})
  target_include_directories(gridspace_${name} SYSTEM PUBLIC "${out}")
  target_link_libraries(gridspace_${name} PUBLIC fastcdr fastrtps)
  target_compile_options(gridspace_${name} PRIVATE -w)
endfunction()
