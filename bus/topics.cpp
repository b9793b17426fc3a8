// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/topics.hpp"

#include "idl/idl_texts.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace gridspace::bus {
namespace {

constexpr std::array<std::string_view, 6> kManagement{"simulation_clock", "clock_ack",      "member_status",
                                                      "type_catalog",     "signal_catalog", "signals"};
constexpr std::array<std::string_view, 2> kDiagnostic{"member_status", "type_catalog"};

} // namespace

bool is_management_topic(std::string_view topic) {
    return std::find(kManagement.begin(), kManagement.end(), topic) != kManagement.end();
}

bool is_diagnostic_topic(std::string_view topic) {
    return std::find(kDiagnostic.begin(), kDiagnostic.end(), topic) != kDiagnostic.end();
}

std::string_view idl_of_type(std::string_view type_name) {
    std::string const head = "struct " + std::string{type_name};
    for (IdlText const& idl : idl_texts()) {
        for (std::size_t at = idl.text.find(head); at != std::string_view::npos; at = idl.text.find(head, at + 1)) {
            std::size_t const end = at + head.size();
            if (end < idl.text.size() && (idl.text[end] == ' ' || idl.text[end] == '\n' || idl.text[end] == '{')) {
                return idl.text;
            }
        }
    }
    return {};
}

} // namespace gridspace::bus
