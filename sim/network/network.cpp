// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/network.hpp"

namespace gridspace::sim {

Scale NetworkAround::scale(Ref const& name) const {
    Profile const* profile = name.empty() ? nullptr : sim::find(n_.profiles, name.name);
    if (profile == nullptr) {
        return [](double) { return 1.0; };
    }
    return [profile = *profile, start_hour_of_day = start_hour_of_day_](double t_s) {
        return profile.value_at(t_s / 3600, start_hour_of_day);
    };
}

Element const* NetworkAround::element(std::string_view section, Ref const& name) const {
    if (name.empty()) {
        return nullptr;
    }
    if (section == Bus::kKind.section) { // there are many of them
        std::size_t const i = buses_[name.name];
        return i < n_.buses.size() ? &n_.buses[i] : nullptr;
    }
    Element const* found = nullptr;
    for_each_kind(n_, [&]<class T>(std::vector<T> const& elements) {
        if (T::kKind.section == section) {
            found = sim::find(elements, name.name);
        }
    });
    return found;
}

double profile_value(Network const& network, Ref const& name, double hours, double start_hour_of_day) {
    Profile const* profile = name.empty() ? nullptr : find(network.profiles, name.name);
    return profile == nullptr ? 1 : profile->value_at(hours, start_hour_of_day);
}

} // namespace gridspace::sim
