// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/topics.hpp"

#include "common/idl/idl_model.hpp"
#include "idl/idl_texts.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace gridspace::bus {
namespace {

constexpr std::array<std::string_view, 7> kManagement{
    "simulation_clock", "clock_ack", "member_status", "type_catalog", "signal_catalog", "signals", "stream_statistics"};
constexpr std::array<std::string_view, 3> kDiagnostic{"member_status", "type_catalog", "stream_statistics"};

} // namespace

bool is_management_topic(std::string_view topic) {
    return std::find(kManagement.begin(), kManagement.end(), topic) != kManagement.end();
}

bool is_diagnostic_topic(std::string_view topic) {
    return std::find(kDiagnostic.begin(), kDiagnostic.end(), topic) != kDiagnostic.end();
}

std::string_view idl_of_type(std::string_view type_name) {
    std::size_t const scope = type_name.rfind("::");
    std::string const head = "struct " + std::string{type_name.substr(scope == std::string_view::npos ? 0 : scope + 2)};
    for (IdlText const& entry : idl_texts()) {
        for (std::size_t at = entry.text.find(head); at != std::string_view::npos; at = entry.text.find(head, at + 1)) {
            std::size_t const end = at + head.size();
            if (end < entry.text.size() &&
                (entry.text[end] == ' ' || entry.text[end] == '\n' || entry.text[end] == '{')) {
                auto const model = idl::parse(entry.text);
                if (model && model->find(type_name)) {
                    return entry.text;
                }
            }
        }
    }
    return {};
}

} // namespace gridspace::bus
