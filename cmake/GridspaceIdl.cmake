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
  set(together "")
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
    string(APPEND together "#include \"${stem}.cxx\"\n#include \"${stem}PubSubTypes.cxx\"\n")
  endforeach()
  if(GRIDSPACE_TOGETHER GREATER 1) # as other sources (GridspaceTargets.cmake)
    set_source_files_properties(${sources} PROPERTIES HEADER_FILE_ONLY ON)
    file(CONFIGURE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/together/${name}_types.cxx" CONTENT "${together}" @ONLY)
    list(APPEND sources "${CMAKE_CURRENT_BINARY_DIR}/together/${name}_types.cxx")
  endif()
  add_library(gridspace_${name} STATIC ${sources})
  add_library(gridspace::${name} ALIAS gridspace_${name})
  target_include_directories(gridspace_${name} SYSTEM PUBLIC "${out}")
  target_link_libraries(gridspace_${name} PUBLIC fastcdr fastrtps)
  target_compile_options(gridspace_${name} PRIVATE -w)
endfunction()

# gridspace_codecs(OUT a.idl b.idl ...): the sources that register the types of these files (bus/codec.hpp): their codecs, and the
# registry of all. A topic type is a structure that is no member of another one. Types of ours are in no module.
function(gridspace_codecs out)
  set(folder "${CMAKE_CURRENT_BINARY_DIR}/types")
  set(head "// Made from idl/ by cmake/GridspaceIdl.cmake.\n")
  set(includes "")
  set(codec_includes "")
  set(codecs "")
  set(entries "")
  foreach(idl IN LISTS ARGN)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${idl}")
    get_filename_component(stem "${idl}" NAME_WE)
    file(READ "${idl}" text)
    string(REGEX REPLACE "//[^\n]*" "" text "${text}")
    string(REGEX REPLACE "[^A-Za-z0-9_]+" " " words " ${text} ")
    if(words MATCHES " module ")
      message(FATAL_ERROR "${idl}: types of the framework are in no module; those of users belong into idl/user")
    endif()
    string(REGEX MATCHALL " struct [A-Za-z0-9_]+" structures "${words}")
    foreach(structure IN LISTS structures)
      string(REPLACE " struct " "" type "${structure}")
      string(REGEX MATCHALL " ${type} " uses "${words}")
      list(LENGTH uses count)
      if(count EQUAL 1)
        string(APPEND codecs "GRIDSPACE_CODEC(${type})\n")
        string(APPEND entries "        &codec_of<${type}>(),\n")
      endif()
    endforeach()
    string(APPEND codec_includes "#include <${stem}PubSubTypes.h>\n")
    string(APPEND includes "#include <${stem}.h>\n")
  endforeach()
  file(CONFIGURE OUTPUT "${folder}/codecs.cpp" CONTENT "${head}#include \"bus/codec_impl.hpp\"\n\n${codec_includes}\n${codecs}" @ONLY)
  file(CONFIGURE OUTPUT "${folder}/registry.cpp" @ONLY CONTENT
"${head}#include \"bus/codec.hpp\"

#include <array>
${includes}
namespace gridspace::bus {

Codec const* find_codec(std::string_view type_name) {
    static std::array const kAll{
${entries}    };
    for (Codec const* codec : kAll) {
        if (codec->type_name == type_name) {
            return codec;
        }
    }
    return nullptr;
}

} // namespace gridspace::bus
")
  set(${out} "${folder}/codecs.cpp" "${folder}/registry.cpp" PARENT_SCOPE)
endfunction()
