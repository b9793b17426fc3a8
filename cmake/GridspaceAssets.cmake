# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# gridspace_assets(OUTPUT TEMPLATE ASSETS "/url|text type|file[|packed file]" ...): a C++ source that holds the files
# themselves (.incbin: neither g++ 12 nor CMake can embed). Recompiled when a file changes.
function(gridspace_assets output)
  cmake_parse_arguments(arg "" "" "ASSETS" ${ARGN})
  set(blocks "")
  set(entries "")
  set(files "")
  set(n 0)
  foreach(asset IN LISTS arg_ASSETS)
    string(REPLACE "|" ";" parts "${asset}")
    list(GET parts 0 url)
    list(GET parts 1 type)
    list(LENGTH parts count)
    set(spans "")
    foreach(i IN ITEMS 2 3)
      if(i LESS count)
        list(GET parts ${i} file)
        list(APPEND files "${file}")
        set(symbol "gridspace_asset_${n}_${i}")
        string(APPEND blocks "asm(\".pushsection .rodata\\n.global ${symbol}\\n${symbol}:\\n.incbin \\\"${file}\\\"\\n.global "
               "${symbol}_end\\n${symbol}_end:\\n.byte 0\\n.popsection\");\n"
               "extern \"C\" { extern char const ${symbol}[], ${symbol}_end[]; }\n")
        string(APPEND spans ", {${symbol}, static_cast<std::size_t>(${symbol}_end - ${symbol})}")
      else()
        string(APPEND spans ", {}")
      endif()
    endforeach()
    string(APPEND entries "        make(\"${url}\", \"${type}; charset=utf-8\"${spans}),\n") # a semicolon would split the list
    math(EXPR n "${n} + 1")
  endforeach()
  set(GRIDSPACE_ASSET_BLOCKS "${blocks}")
  set(GRIDSPACE_ASSET_ENTRIES "${entries}")
  configure_file("${PROJECT_SOURCE_DIR}/monitor/app/assets.cpp.in" "${output}" @ONLY)
  set_source_files_properties("${output}" PROPERTIES OBJECT_DEPENDS "${files}")
endfunction()
