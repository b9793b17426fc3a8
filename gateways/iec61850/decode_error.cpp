// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/decode_error.hpp"

#include <fmt/format.h>

namespace gridspace::iec61850 {
namespace {

struct ReasonText {
    std::string_view name, sentence;
};

constexpr std::array<ReasonText, kReasons> kTexts{{
    {"none", "nothing is wrong"},
    {"too_short", "the frame ends before its header does"},
    {"other_ethertype", "the frame has another ethertype"},
    {"bad_frame_length", "the Length field does not fit the frame"},
    {"truncated", "an element is longer than what contains it"},
    {"bad_length_form", "a length is in a form that is not allowed"},
    {"bad_tag", "another element was expected"},
    {"missing_field", "a mandatory element is missing"},
    {"duplicate_field", "an element occurs twice"},
    {"bad_value", "a value has an impossible length or range"},
    {"too_deep", "structures are nested too deeply"},
    {"count_mismatch", "noASDU is not the number of ASDUs"},
    {"too_many", "there are more ASDUs than a frame can hold"},
}};

} // namespace

std::string_view reason_name(Reason reason) noexcept {
    return kTexts[static_cast<std::size_t>(reason)].name;
}

std::string describe(DecodeError const& error) {
    std::string_view const sentence = kTexts[static_cast<std::size_t>(error.reason)].sentence;
    return error.tag == 0 ? fmt::format("{} (octet {})", sentence, error.offset)
                          : fmt::format("{} (tag 0x{:02X}, octet {})", sentence, error.tag, error.offset);
}

} // namespace gridspace::iec61850
