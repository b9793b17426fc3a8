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

# Bounded strings are read by way of a std::string, which takes from the heap from 16 characters on: once per ledger line and
# tick. A buffer on the stack does not. (Checked by ClockPath.TakesNothingFromTheHeapOnceEverybodyHasBeenHeard.)
set(bounded_text [=[
using namespace eprosima::fastcdr::exception;

#ifndef GRIDSPACE_BOUNDED_TEXT // once where several are compiled together
#define GRIDSPACE_BOUNDED_TEXT
namespace {
struct BoundedText {
    char text[1025];
    char const* c_str() const { return text; }
};
inline void operator>>(eprosima::fastcdr::Cdr& cdr, BoundedText& out) {
    uint32_t size = 0;
    cdr >> size;
    if (size > sizeof out.text - 1) {
        throw BadParamException("a bounded string is too long");
    }
    cdr.deserializeArray(out.text, size);
    out.text[size] = 0;
}
} // namespace
#endif
]=])
file(READ "${OUT}/${STEM}.cxx" generated)
if(generated MATCHES "std::string aux;")
  string(REPLACE "        std::string aux;" "        BoundedText aux;" generated "${generated}")
  string(REPLACE "using namespace eprosima::fastcdr::exception;\n" "${bounded_text}" generated "${generated}")
  file(WRITE "${OUT}/${STEM}.cxx" "${generated}")
endif()
