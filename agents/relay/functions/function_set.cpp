// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/function_set.hpp"

#include <array>

namespace gridspace::relay {
namespace {

constexpr std::array<std::string_view, 12> kNames{"RDIR", "PTOC", "PIOC", "PDIS", "PTUV", "PTOV",
                                                  "PTUF", "PTOF", "PFRC", "RSYN", "RBRF", "RREC"};
constexpr std::array<std::string_view, 12> kNumbers{"67",  "51",  "50",  "21", "27",   "59",
                                                    "81U", "81O", "81R", "25", "50BF", "79"};

} // namespace

std::string_view name_of(NodeClass of) {
    return kNames[static_cast<std::size_t>(of)];
}

std::string_view device_number(NodeClass of) {
    return kNumbers[static_cast<std::size_t>(of)];
}

bool class_in(std::string_view name, NodeClass& of) {
    std::size_t const end = name.find_last_not_of("0123456789");
    if (end == std::string_view::npos || end + 1 == name.size() || end < 3) {
        return false;
    }
    std::string_view const word = name.substr(end - 3, 4);
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        if (word == kNames[i]) {
            of = static_cast<NodeClass>(i);
            return true;
        }
    }
    return false;
}

void FunctionSet::step(Measurement const& measured, bool trip) {
    picks_up_ = operates_ = closes_ = false;
    for (std::size_t i = 0; i < functions_.size(); ++i) {
        NamedFunction& f = functions_[i];
        blocked_[i] = (f.function->needs() & ~measured.available) != 0;
        if (blocked_[i]) {
            f.function->reset();
            states_[i] = {};
            continue;
        }
        states_[i] = f.function->step({measured, states_, trip});
        if (f.trips) {
            picks_up_ = picks_up_ || states_[i].str;
            operates_ = operates_ || states_[i].op;
        }
        closes_ = closes_ || (f.of == NodeClass::rrec && states_[i].op);
    }
}

} // namespace gridspace::relay
