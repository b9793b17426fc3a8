# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# Runs fastddsgen and shows what it prints only when it fails. Its temporary folder is its own: two at once would clash.
file(MAKE_DIRECTORY "${OUT}/${STEM}.tmp")
execute_process(
  COMMAND "${FASTDDSGEN}" -replace -cs -I "${DIR}" -t "${OUT}/${STEM}.tmp" -d "${OUT}" "${IDL}"
  RESULT_VARIABLE result
  OUTPUT_VARIABLE printed
  ERROR_VARIABLE printed)
if(result OR NOT EXISTS "${OUT}/${STEM}.cxx")
  message(FATAL_ERROR "fastddsgen ${IDL} failed (${result}):\n${printed}")
endif()
