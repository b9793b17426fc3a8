// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/diagram/shapes.hpp"

#include <algorithm>
#include <array>

namespace gridspace::diagram {

DeviceShape shape_of(std::string_view kind) {
    static constexpr std::array<std::string_view, 5> kCircles{"machine", "generator", "pv", "induction_machine",
                                                              "wind_turbine"};
    static constexpr std::array<std::string_view, 3> kStores{"ev", "battery", "supercapacitor"};
    return kind == "source"                                                      ? DeviceShape::source
           : std::find(kCircles.begin(), kCircles.end(), kind) != kCircles.end() ? DeviceShape::circle
           : std::find(kStores.begin(), kStores.end(), kind) != kStores.end()    ? DeviceShape::store
                                                                                 : DeviceShape::arrow;
}

double label_offset(DeviceShape shape) {
    return shape == DeviceShape::source   ? 27
           : shape == DeviceShape::circle ? 21
           : shape == DeviceShape::store  ? 35
                                          : 14;
}

double room_of(DeviceShape shape) {
    return shape == DeviceShape::store ? 1.4 * kValueRoom : kValueRoom;
}

double width_of(std::string_view text) {
    double out = 0;
    for (char const c : text) {
        bool const wide = (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
        out += (c & 0xC0) == 0x80 ? 0 : wide ? 7.6 : c == ' ' || c == '.' || c == ',' || c == 'i' || c == 'l' ? 4 : 7;
    }
    return out;
}

} // namespace gridspace::diagram
